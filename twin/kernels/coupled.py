"""Play and stem in one loop, for effects in which the target depends on how the stem moves.

Friction inside the force balance, breakaway with a stick speed, friction that falls with speed, wear with distance,
forces that depend on where the stem is (not on where it is pulled to).
The small functions stand here once more on purpose: a compiled cache notices edits of its own file only.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    FOREVER,
    V_AGING_S,
    V_BREAKAWAY,
    V_HELD,
    V_IN_MOTION,
    V_RATE_CLOSE,
    V_RATE_OPEN,
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

#: First pressure, step, closing and opening curve; and the spreads and weights of the elements.
Tables = tuple[float, float, FloatArray, FloatArray]
Plays = tuple[FloatArray, FloatArray]
#: Over the stem's position, 0 .. travel: extra pressure (closing, opening), compliance relative to the design's; single
#: points where the stem's position does not matter.
Bends = tuple[FloatArray, FloatArray, FloatArray]
#: What the half deadband grows by (closing, opening), compliance relative to the design's.
Grown = tuple[float, float, float]
#: Stem, play output, that output lagged, whether it sticks, speed, last way, distance travelled, time stuck [s].
State = tuple[float, float, float, bool, float, float, float, float]

_SAME = 1e-9


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _look_up(p: float, p_first: float, p_step: float, table: FloatArray) -> float:
    """Linear interpolation in a uniform table, extended by its end slopes."""
    q = (p - p_first) / p_step
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
def _toward(x: float, w_a: float, w_b: float, lag: FloatArray) -> float:
    """Exact step of a lag for an input linear from w_a to w_b."""
    slope_tau = (w_b - w_a) * lag[1]
    new: float = w_b - slope_tau + (x - w_a + slope_tau) * lag[0]
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
def _held(
    q: float, band: Grown, extra: tuple[float, float], inside: bool, stops: FloatArray, tables: Tables
) -> tuple[float, float]:
    """Between which two positions an element stays at pressure `q` that needs `extra` (closing, opening) to start."""
    p_first, p_step, closing, opening = tables
    bottom = band[2] * _look_up(q - band[0] - extra[0], p_first, p_step, closing)
    top = band[2] * _look_up(q + band[1] + extra[1], p_first, p_step, opening)
    if inside:  # what the stops keep the play from does not pull at it
        free_bottom = band[2] * _look_up(q - band[0], p_first, p_step, closing)
        free_top = band[2] * _look_up(q + band[1], p_first, p_step, opening)
        bottom += min(stops[1], max(stops[0], free_bottom)) - free_bottom
        top += min(stops[1], max(stops[0], free_top)) - free_top
    return bottom, top


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _play_step(
    q: float,
    grown: Grown,
    extra: tuple[float, float],
    modes: tuple[bool, bool],
    stops: FloatArray,
    tables: Tables,
    plays: Plays,
    elements: FloatArray,
) -> tuple[float, bool]:
    """Moves the elements to pressure `q`; those that `extra` (closing, opening) holds stay.

    `modes`: whether they jump, and whether only what lies inside the stops pulls. Returns their sum and whether any
    slipped.
    """
    p_first, p_step, closing, opening = tables
    w = 0.0
    slipped = False
    for j in range(elements.size):
        e = elements[j]
        band = (plays[0][j] + grown[0], plays[0][j] + grown[1], grown[2])
        held = (e, e)
        if extra[0] > 0.0 or extra[1] > 0.0:
            held = _held(q, band, extra, modes[1], stops, tables)
            if held[0] <= e <= held[1]:
                w += plays[1][j] * e
                continue
        bottom = band[2] * _look_up(q - band[0], p_first, p_step, closing)
        top = band[2] * _look_up(q + band[1], p_first, p_step, opening)
        if modes[0] and extra[0] > 0.0:
            bottom = _jumps(e, bottom, held[0]) if bottom > e else bottom
            top = _jumps(e, top, held[1]) if top < e else top
        slipped = True
        e = max(stops[0], min(stops[1], max(bottom, min(top, e))))
        elements[j] = e
        w += plays[1][j] * e
    return w, slipped


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _half_band(wide: float, state: State, c: FloatArray, bends: Bends) -> Grown:
    """What is added to the half deadband now, by time, wear, speed and where the stem is; and the compliance there."""
    grown: float = wide + c[V_WEAR] * state[6]
    if c[V_STRIBECK] > 0.0:
        grown += c[V_STRIBECK] * np.exp(-state[4] / c[V_STRIBECK_SPEED])
    if bends[0].size == 1:
        return grown, grown, 1.0
    step = c[V_TRAVEL] / (bends[0].size - 1)
    closing, opening = _look_up(state[0], 0.0, step, bends[0]), _look_up(state[0], 0.0, step, bends[1])
    return grown + closing, grown - opening, _look_up(state[0], 0.0, step, bends[2])


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _breakaway(state: State, c: FloatArray) -> tuple[float, float]:
    """What it takes beyond sliding friction to close and to open now.

    A stem that moves passes rest before it can move the other way: there it has to break away again.
    """
    extra = c[V_BREAKAWAY]
    if c[V_AGING_S] > 0.0:
        extra *= 1.0 - np.exp(-state[7] / c[V_AGING_S])
    slides = 0.0 if state[3] else state[5]
    return 0.0 if slides > 0.0 else extra, 0.0 if slides < 0.0 else extra


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _bounded(x: float, new: float, h: float, c: FloatArray, stops: FloatArray) -> float:
    """The stem after `h` seconds on its way from x to `new`, no faster than its rates and within its stops."""
    slow = max(x - c[V_RATE_OPEN] * h, min(x + c[V_RATE_CLOSE] * h, new))
    bounded: float = max(stops[2], min(stops[3], slow))
    return bounded


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _move(
    h: float, new_w: float, slipped: bool, c: FloatArray, stops: FloatArray, lags: FloatArray, state: State
) -> State:
    """The state after `h` seconds in which the stem moves toward the play output `new_w`."""
    x, w, after, stuck, _, toward, travelled, rested = state
    new_after = _toward(after, w, new_w, lags[2])
    new = _bounded(x, _toward(x, after, new_after, lags[0 if after + new_after > 2.0 * x else 1]), h, c, stops)
    if c[V_HELD] > 0.0:
        slipped = abs(new_after - x) > c[V_HELD]
        new = x if stuck and not slipped else new
    speed = abs(new - x) / h
    deciding = abs(new_w - w) / h if c[V_TARGET_STICKS] != 0.0 else speed
    stuck = (stuck and not slipped) or deciding < c[V_STICK_SPEED]
    rested = rested + h if stuck else 0.0
    toward = new - x if new != x else toward
    return new, new_w, new_after, stuck, speed, toward, travelled + abs(new - x), rested


@njit(cache=True, nogil=True, error_model="numpy")
def coupled_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    plays: Plays,
    bends: Bends,
    start: tuple[float, float],
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem. `stops`: of the play, of the stem; `start`: (x, w)."""
    elements = np.full(plays[0].size, start[1])
    x = max(stops[2], min(stops[3], start[0]))
    state = (x, start[1], start[1], True, 0.0, 0.0, 0.0, FOREVER)
    grown = _half_band(widening[0], state, c, bends)
    w, _ = _play_step(force[0], grown, (0.0, 0.0), (False, False), stops, tables, plays, elements)
    state = (x, w, w, True, 0.0, 0.0, 0.0, FOREVER)
    out[0] = x
    last_h = -1.0
    lags = np.zeros((3, 2))
    modes = (c[V_STICK_SPEED] >= FOREVER, c[V_TARGET_STICKS] != 0.0)
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h = h
            _decays(h, c, lags)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            grown = _half_band(widening[f if widening.size > 1 else 0], state, c, bends)
            if c[V_IN_MOTION] != 0.0:
                elements += c[V_IN_MOTION] * (state[0] - state[1])
            extra = _breakaway(state, c)
            w, slipped = _play_step(force[f], grown, extra, modes, stops, tables, plays, elements)
            state = _move(h, w, slipped, c, stops, lags, state)
            out[f] = state[0]
