"""Play and stem in one loop, for effects in which the target depends on how the stem moves.

Friction inside the force balance, breakaway with a stick speed, friction that falls with speed, wear with distance,
forces that depend on where the stem is (not on where it is pulled to).
The small functions stand here once more on purpose: a compiled cache notices edits of its own file only.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Bends, Grown, Plays, Tables
from twin.slots import (
    FOREVER,
    V_AGING_S,
    V_BREAKAWAY,
    V_HELD,
    V_IN_MOTION,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_SHORT,
    V_STICK_SPEED,
    V_STRIBECK,
    V_STRIBECK_SPEED,
    V_TARGET_STICKS,
    V_TAU_AFTER_S,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_TRAVEL,
    V_WEAR,
)

_SAME = 1e-9


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _curve_at(p: float, grid: tuple[float, float], table: FloatArray) -> float:
    """Linear interpolation at `p` in a table, extended by its end slopes; `grid`: first point, points per unit."""
    q = (p - grid[0]) * grid[1]
    i = min(max(int(q), 0), table.size - 2)
    value: float = table[i] + (q - i) * (table[i + 1] - table[i])
    return value


@njit(cache=True, nogil=True, error_model="numpy")
def _decays(h: float, c: FloatArray, lags: FloatArray) -> None:
    """Fills `lags` (shape (3, 2)): decay over `h` and tau / h, of the lags closing, opening and after the play."""
    for k, slot in enumerate((V_TAU_CLOSE_S, V_TAU_OPEN_S, V_TAU_AFTER_S)):
        lags[k, 0] = np.exp(-h / c[slot]) if c[slot] > 1e-9 else 0.0
        lags[k, 1] = c[slot] / h if c[slot] > 1e-9 else 0.0


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _toward(x: float, w_a: float, w_b: float, decay: float, reach: float) -> float:
    """Exact step of a lag for an input linear from w_a to w_b."""
    slope_tau = (w_b - w_a) * reach
    new: float = w_b - slope_tau + (x - w_a + slope_tau) * decay
    return new


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _jumps(e: float, free: float, held: float) -> float:
    """Where an element that sticks again at once stands: whole jumps away from `e`, the last one short of `free`.

    A jump is the distance between the curves with and without the breakaway. Counting them, instead of landing on
    `free`, makes the outcome of a fast change of pressure independent of the fine step.
    """
    jump = free - held
    where: float = free if jump == 0.0 else e + np.floor((free - e) / jump + 1e-9) * jump
    return where


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _unheld(free: float, held: float, inside: bool, ends: tuple[float, float]) -> float:
    """Where the breakaway holds an element, if what the stops keep the play from does not pull at it."""
    return held + min(ends[1], max(ends[0], free)) - free if inside else held


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _element(
    e: float,
    down: float,
    up: float,
    softer: float,
    extra: tuple[float, float],
    modes: tuple[bool, bool],
    ends: tuple[float, float],
    grid: tuple[float, float],
    closing: FloatArray,
    opening: FloatArray,
) -> tuple[float, bool]:
    """Where an element goes that closes at pressure `down` and opens at `up`, and whether it slipped.

    `extra`: what it takes to start (closing, opening). `modes`: whether it jumps, and whether only what lies inside
    the stops pulls. `ends`: the stops. `grid`: first pressure and points per pressure of the curves.
    """
    bottom, top = softer * _curve_at(down, grid, closing), softer * _curve_at(up, grid, opening)
    if extra[0] > 0.0 or extra[1] > 0.0:
        low = _unheld(bottom, softer * _curve_at(down - extra[0], grid, closing), modes[1], ends)
        high = _unheld(top, softer * _curve_at(up + extra[1], grid, opening), modes[1], ends)
        if low <= e <= high:
            return e, False
        if modes[0] and extra[0] > 0.0:
            bottom = _jumps(e, bottom, low) if bottom > e else bottom
            top = _jumps(e, top, high) if top < e else top
    return max(ends[0], min(ends[1], max(bottom, min(top, e)))), True


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _half_band(
    wide: float, x: float, speed: float, c: FloatArray, closing: FloatArray, opening: FloatArray, softer: FloatArray
) -> Grown:
    """What is added to the half deadband now, by wear (in `wide`), speed and place; and the compliance there."""
    grown = wide
    if c[V_STRIBECK] > 0.0:
        grown += c[V_STRIBECK] * np.exp(-speed / c[V_STRIBECK_SPEED])
    if closing.size == 1:
        return grown, grown, 1.0
    grid = (0.0, (closing.size - 1) / c[V_TRAVEL])
    return grown + _curve_at(x, grid, closing), grown - _curve_at(x, grid, opening), _curve_at(x, grid, softer)


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _breakaway(stuck: bool, toward: float, rested: float, c: FloatArray) -> tuple[float, float]:
    """What it takes beyond sliding friction to close and to open now.

    A stem that moves passes rest before it can move the other way: there it has to break away again.
    """
    extra = c[V_BREAKAWAY]
    if c[V_AGING_S] > 0.0:
        extra *= 1.0 - np.exp(-rested / c[V_AGING_S])
    slides = 0.0 if stuck else toward
    return 0.0 if slides > 0.0 else extra, 0.0 if slides < 0.0 else extra


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _move(
    h: float,
    new_w: float,
    slipped: bool,
    c: FloatArray,
    stops: FloatArray,
    lags: FloatArray,
    x: float,
    w: float,
    after: float,
    stuck: bool,
    speed: float,
) -> tuple[float, float, bool]:
    """Stem, lagged play output and whether it sticks, after `h` seconds in which it moves toward `new_w`."""
    new_after = _toward(after, w, new_w, lags[2, 0], lags[2, 1])
    way = 0 if after + new_after > 2.0 * x else 1  # a row of `lags` taken out would count references
    pulls, will_pull = after, new_after
    if c[V_SHORT] > 0.0:
        short = c[V_SHORT] * np.exp(-speed / c[V_STRIBECK_SPEED])
        pulls -= max(-short, min(short, after - x))
        will_pull -= max(-short, min(short, new_after - x))
    new = _toward(x, pulls, will_pull, lags[way, 0], lags[way, 1])
    new = max(x - c[V_RATE_OPEN] * h, min(x + c[V_RATE_CLOSE] * h, new))
    new = max(stops[2], min(stops[3], new))
    if c[V_HELD] > 0.0:
        slipped = abs(new_after - x) > c[V_HELD]
        new = x if stuck and not slipped else new
    deciding = abs(new_w - w) if c[V_TARGET_STICKS] != 0.0 else abs(new - x)
    return new, new_after, (stuck and not slipped) or deciding < c[V_STICK_SPEED] * h


@njit(cache=True, nogil=True, error_model="numpy")
def coupled_start(
    force: float,
    wide: float,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    plays: Plays,
    bends: Bends,
    start: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """State (see `coupled_steps`) and elements at rest; `start`: (x, w), `stops`: of the play, of the stem."""
    grid, ends = (tables[0], 1.0 / tables[1]), (stops[0], stops[1])
    elements = np.full(plays[0].size, start[1])
    x = max(stops[2], min(stops[3], start[0]))
    more, less, softer = _half_band(wide, x, 0.0, c, bends[0], bends[1], bends[2])
    w = 0.0
    for j in range(elements.size):
        down, up = force - plays[0][j] - more, force + plays[0][j] + less
        elements[j], _ = _element(
            elements[j], down, up, softer, (0.0, 0.0), (False, False), ends, grid, tables[2], tables[3]
        )
        w += plays[1][j] * elements[j]
    return np.array([x, w, w, 1.0, 0.0, 0.0, 0.0, FOREVER]), elements


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
    [s].
    """
    # Arrays are taken out of their tuples, and out of other arrays, once: in the loop it would count references.
    grid, closing, opening = (tables[0], 1.0 / tables[1]), tables[2], tables[3]
    spreads, weights = plays
    more_at, less_at, softer_at = bends
    ends, varies = (stops[0], stops[1]), widening.size > 1
    modes = (c[V_STICK_SPEED] >= FOREVER, c[V_TARGET_STICKS] != 0.0)
    x, w, after, stuck = state[0], state[1], state[2], state[3] != 0.0
    speed, toward, travelled, rested = state[4], state[5], state[6], state[7]
    out[0] = x
    last_h, lags = -1.0, np.zeros((3, 2))
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h = h
            _decays(h, c, lags)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            wide = widening[f if varies else 0] + c[V_WEAR] * travelled
            more, less, softer = _half_band(wide, x, speed, c, more_at, less_at, softer_at)
            extra, carried = _breakaway(stuck, toward, rested, c), c[V_IN_MOTION] * (x - w)
            new_w, slipped = 0.0, False
            for j in range(elements.size):
                down, up = force[f] - spreads[j] - more, force[f] + spreads[j] + less
                e, slips = _element(elements[j] + carried, down, up, softer, extra, modes, ends, grid, closing, opening)
                slipped = slipped or slips
                elements[j] = e
                new_w += weights[j] * e
            new, after, stuck = _move(h, new_w, slipped, c, stops, lags, x, w, after, stuck, speed)
            speed, travelled = abs(new - x) / h, travelled + abs(new - x)
            rested, toward = rested + h if stuck else 0.0, new - x if new != x else toward
            x, w = new, new_w
            out[f] = x
    state[0], state[1], state[2], state[3] = x, w, after, 1.0 if stuck else 0.0
    state[4], state[5], state[6], state[7] = speed, toward, travelled, rested
