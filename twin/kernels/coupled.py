"""Play and stem in one loop (from `coupled_start`), for effects in which the target depends on how the stem moves.

Friction in the force balance or on the stem, breakaway, friction that falls or grows with speed, wear, a spring that
relaxes, forces by where the stem is. Small functions stand here once more on purpose: a compiled cache notices edits
of its own file only. They are given numbers: an array counts references, each step, which cost more than the physics.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Bends, Plays, Tables
from twin.kernels.slots import FOREVER
from twin.kernels.valve_slots import (
    V_AGING_S,
    V_BREAKAWAY,
    V_DRAG_CLOSE_S,
    V_DRAG_OPEN_S,
    V_EASES,
    V_EASES_AT,
    V_FADES_SQUARED,
    V_HELD,
    V_IN_MOTION,
    V_KEPT,
    V_ON_STEM,
    V_OUTER,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_RELAX,
    V_RELAX_TAU_S,
    V_SHORT,
    V_SQUARED_S,
    V_STICK_SPEED,
    V_STRIBECK,
    V_STRIBECK_SPEED,
    V_TARGET_STICKS,
    V_TAU_AFTER_S,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_TRAVEL,
    V_WEAR,
    V_WITHIN,
)

_SAME = 1e-9

Pair = tuple[float, float]


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _curve_at(p: float, grid: tuple[float, float], table: FloatArray) -> float:
    """Linear interpolation at `p` in a table, extended by its end slopes; `grid`: first point, points per unit."""
    q = (p - grid[0]) * grid[1]
    i = min(max(int(q), 0), table.size - 2)
    value: float = table[i] + (q - i) * (table[i + 1] - table[i])
    return value


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _decay(h: float, tau_s: float) -> tuple[float, float]:
    """Decay of a lag over `h`, and tau / h."""
    return (np.exp(-h / tau_s), tau_s / h) if tau_s > 1e-9 else (0.0, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def _lags(h: float, c: FloatArray) -> tuple[tuple[Pair, Pair], tuple[Pair, Pair], Pair, float]:
    """Decays over `h`: (closing, opening), the same with drag, of the lag after the play, of what relaxes."""
    close_s, open_s = c[V_TAU_CLOSE_S], c[V_TAU_OPEN_S]
    drags = (_decay(h, close_s + c[V_DRAG_CLOSE_S]), _decay(h, open_s + c[V_DRAG_OPEN_S]))
    return (_decay(h, close_s), _decay(h, open_s)), drags, _decay(h, c[V_TAU_AFTER_S]), np.exp(-h / c[V_RELAX_TAU_S])


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _throttled(h: float, c: FloatArray, way: int, pull: float, drag: Pair) -> Pair:
    """`drag` over `h`, or where it grows with the speed what the law has at the speed that so far a pull makes."""
    if c[V_SQUARED_S + way] <= 0.0:
        return drag
    tau_s = c[V_TAU_CLOSE_S + way] + c[V_DRAG_CLOSE_S + way]
    return _decay(h, 0.5 * (tau_s + np.sqrt(tau_s * tau_s + 4.0 * c[V_SQUARED_S + way] * abs(pull))))


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _toward(x: float, w_a: float, w_b: float, lag: tuple[float, float]) -> float:
    """Exact step of a lag for an input linear from w_a to w_b."""
    slope_tau = (w_b - w_a) * lag[1]
    new: float = w_b - slope_tau + (x - w_a + slope_tau) * lag[0]
    return new


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _jumps(e: float, free: float, held: float) -> float:
    """Where an element that sticks again at once stands: whole jumps away from `e`, the last one short of `free`.

    A jump: the distance that the breakaway makes between curves. Counting makes the fine step indifferent.
    """
    jump = free - held
    where: float = free if jump == 0.0 else e + np.floor((free - e) / jump + 1e-9) * jump
    return where


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _unheld(free: float, held: float, inside: bool, ends: tuple[float, float]) -> float:
    """Where the breakaway holds an element, if what the stops keep the play from does not pull at it."""
    return held + min(ends[1], max(ends[0], free)) - free if inside else held


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _element(e: float, free: Pair, held: Pair, extra: Pair, modes: tuple[bool, bool], ends: Pair) -> tuple[float, bool]:
    """Where an element goes between its curves (closing, opening), `free` and as the breakaway holds it; if it slipped.

    `extra`: what it takes to start, `modes`: whether it jumps, whether only what lies inside the stops `ends` pulls.
    """
    bottom, top = free
    if extra[0] > 0.0 or extra[1] > 0.0:
        low = _unheld(bottom, held[0], modes[1], ends)
        high = _unheld(top, held[1], modes[1], ends)
        if low <= e <= high:
            return e, False
        if modes[0] and extra[0] > 0.0:
            bottom = _jumps(e, bottom, low) if bottom > e else bottom
            top = _jumps(e, top, high) if top < e else top
    return max(bottom, min(top, e)), True


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _breakaway(stuck: bool, toward: float, rested: float, force: float, aging_s: float) -> tuple[float, float]:
    """What it takes beyond sliding friction to close and to open now.

    A stem that moves passes rest before it can move the other way: there it has to break away again.
    """
    extra = force
    if aging_s > 0.0:
        extra *= 1.0 - np.exp(-rested / aging_s)
    slides = 0.0 if stuck else toward
    return 0.0 if slides > 0.0 else extra, 0.0 if slides < 0.0 else extra


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _left(target: float, x: float, kept: float) -> float:
    """The target that is left of one when friction keeps so much of its pull on a stem at `x`."""
    return target - max(-kept, min(kept, target - x))


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _moved(x: float, pulls: Pair, over: Pair, end: float, lag: Pair, drag: Pair) -> float:
    """The stem after a step; `pulls`: toward what, before and now, `over`: by how much more if no stop limited it.

    `drag`: the lag where friction grows with speed, for which air has pressure to spare at the stop `end`: of both laws
    the slower one holds.
    """
    if drag[0] == lag[0]:
        return _toward(x, pulls[0], pulls[1], lag)
    free, held = _toward(x, pulls[0] + over[0], pulls[1] + over[1], drag), _toward(x, end, end, lag)
    return free if abs(free - x) < abs(held - x) else held


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _eased(x: float, new: float, pulls: Pair, h: float, c: FloatArray, way: int) -> float:
    """Where a stem comes to that has a lag of its own above a speed, if it came to `new` below it."""
    eases, lag_s = c[V_EASES + way], c[V_TAU_CLOSE_S + way]
    if eases <= 0.0:
        return new
    nearer, lag = c[V_EASES_AT] * lag_s * eases / (1.0 + eases), _decay(h, lag_s / (1.0 + eases))
    if way == 0:
        return max(new, _toward(x, pulls[0] - nearer, pulls[1] - nearer, lag))
    return min(new, _toward(x, pulls[0] + nearer, pulls[1] + nearer, lag))


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _faded(quick: float, squared: bool) -> float:
    """What is left of the friction that falls with the speed, of which `quick` is the share of its own."""
    left: float = np.exp(-quick * (quick if squared else 1.0))
    return left


@njit(cache=True, nogil=True, error_model="numpy")
def coupled_steps(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    plays: Plays,
    bends: Bends,
    state: FloatArray,
    elements: FloatArray,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem and moves `state` and `elements` on.

    `state`: stem, play output, that output lagged, whether it sticks, speed, last way, distance travelled, time stuck
    [s], by how much what pulls the stem is beyond the stops, where the spring is that has relaxed.
    """
    grid, closing, opening = (tables[0], 1.0 / tables[1]), tables[2], tables[3]
    (spreads, weights), (more_at, less_at, softer_at) = plays, bends
    bent, varies, place = more_at.size > 1, widening.size > 1, (0.0, (more_at.size - 1) / c[V_TRAVEL])
    ends, lowest, highest, aging_s = (stops[0], stops[1]), stops[2], stops[3], c[V_AGING_S]
    breakaway, kept, stick_speed, spare = c[V_BREAKAWAY], c[V_HELD], c[V_STICK_SPEED], 1.0 - c[V_WITHIN]
    modes, rests = (stick_speed >= FOREVER, c[V_TARGET_STICKS] == 1.0), c[V_TARGET_STICKS] != 0.0
    stribeck, short, fading, wear, moves = c[V_STRIBECK], c[V_SHORT], c[V_STRIBECK_SPEED], c[V_WEAR], c[V_IN_MOTION]
    x, w, after, stuck, late, relax = state[0], state[1], state[2], state[3] != 0.0, state[9], c[V_RELAX]
    speed, toward, travelled, rested, over = state[4], state[5], state[6], state[7], state[8]
    out[0], on_stem, outer, always, squared = x, c[V_ON_STEM], c[V_OUTER], c[V_KEPT], c[V_FADES_SQUARED] != 0.0
    last_h, rates, (lags, drags, lates, stay) = -1.0, (c[V_RATE_CLOSE], c[V_RATE_OPEN]), _lags(1.0, c)
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h, (lags, drags, lates, stay) = h, _lags(h, c)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            fades = _faded(speed / fading, squared) if stribeck > 0.0 or short > 0.0 else 0.0
            wide = widening[f if varies else 0] + wear * travelled
            rubs, wide = always + on_stem * max(0.0, wide + outer), min(wide, -outer) if on_stem > 0.0 else wide
            more, softer = wide + stribeck * fades, 1.0
            more, less = more + relax * (x - late), more - relax * (x - late)
            if bent:
                more, less = more + _curve_at(x, place, more_at), less - _curve_at(x, place, less_at)
                softer = _curve_at(x, place, softer_at)
            extra, carried = _breakaway(stuck, toward, rested, breakaway, aging_s), moves * (x - w)
            new_w, new_over, slipped = 0.0, 0.0, False
            for j in range(elements.size):
                down, up = force[f] - spreads[j] - more, force[f] + spreads[j] + less
                held = free = (softer * _curve_at(down, grid, closing), softer * _curve_at(up, grid, opening))
                if breakaway > 0.0:
                    low, high = _curve_at(down - extra[0], grid, closing), _curve_at(up + extra[1], grid, opening)
                    held = (softer * low, softer * high)
                reach, slips = _element(elements[j] + carried, free, held, extra, modes, ends)
                elements[j] = max(ends[0], min(ends[1], reach)) if slips else reach
                new_w, slipped = new_w + weights[j] * elements[j], slipped or slips
                new_over += spare * weights[j] * (reach - elements[j])
            new_after = _toward(after, w, new_w, lates)
            pulls = _left(after, x, short * fades + rubs), _left(new_after, x, short * fades + rubs)
            way = 0 if after + new_after > 2.0 * x else 1
            drag = _throttled(h, c, way, 0.5 * (pulls[0] + pulls[1] + over + new_over) - x, drags[way])
            new = _eased(x, _moved(x, pulls, (over, new_over), ends[1 - way], lags[way], drag), pulls, h, c, way)
            new = max(lowest, min(highest, max(x - rates[1] * h, min(x + rates[0] * h, new))))
            if kept > 0.0:
                slipped = abs(new_after - x) > kept
                new = x if stuck and not slipped else new
            stuck = (stuck and not slipped) or abs(new_w - w if rests else new - x) < stick_speed * h
            speed, travelled = abs(new - x) / h, travelled + abs(new - x)
            rested, toward = rested + h if stuck else 0.0, new - x if new != x else toward
            out[f] = x = new
            w, after, over, late = new_w, new_after, new_over, x + (late - x) * stay
    state[0], state[1], state[2], state[3], state[4] = x, w, after, 1.0 if stuck else 0.0, speed
    state[5], state[6], state[7], state[8], state[9] = toward, travelled, rested, over, late
