"""Play and stem in one loop, for effects in which the target depends on how the stem moves.

Friction inside the force balance, breakaway with a stick speed, friction that falls with speed, wear with distance.
The small functions stand here once more on purpose: a compiled cache notices edits of its own file only.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    FOREVER,
    V_BREAKAWAY,
    V_HELD,
    V_IN_MOTION,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_STICK_SPEED,
    V_STRIBECK,
    V_STRIBECK_SPEED,
    V_TAU_AFTER_S,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_WEAR,
)

#: First pressure, step, closing and opening curve; and the spreads and weights of the elements.
Tables = tuple[float, float, FloatArray, FloatArray]
Plays = tuple[FloatArray, FloatArray]

_SAME = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
def _toward(x: float, w_a: float, w_b: float, lag: FloatArray) -> float:
    """Exact step of a lag for an input linear from w_a to w_b."""
    slope_tau = (w_b - w_a) * lag[1]
    new: float = w_b - slope_tau + (x - w_a + slope_tau) * lag[0]
    return new


@njit(cache=True, nogil=True, error_model="numpy")
def _jumps(e: float, free: float, held: float) -> float:
    """Where an element that sticks again at once stands: whole jumps away from `e`, the last one short of `free`.

    A jump is the distance between the curves with and without the breakaway. Counting them, instead of landing on
    `free`, makes the outcome of a fast change of pressure independent of the fine step.
    """
    jump = free - held
    where: float = free if jump == 0.0 else e + np.floor((free - e) / jump + 1e-9) * jump
    return where


@njit(cache=True, nogil=True, error_model="numpy")
def _play_step(
    q: float,
    grown: float,
    extra: float,
    at_once: bool,
    stops: FloatArray,
    tables: Tables,
    plays: Plays,
    elements: FloatArray,
) -> tuple[float, bool]:
    """Moves the elements to pressure `q`; those that `extra` holds stay. Returns their sum and whether any slipped."""
    p_first, p_step, closing, opening = tables
    w = 0.0
    slipped = False
    for j in range(elements.size):
        e = elements[j]
        band = plays[0][j] + grown
        held_bottom = held_top = e
        if extra > 0.0:
            held_bottom = _look_up(q - band - extra, p_first, p_step, closing)
            held_top = _look_up(q + band + extra, p_first, p_step, opening)
            if held_bottom <= e <= held_top:
                w += plays[1][j] * e
                continue
        bottom = _look_up(q - band, p_first, p_step, closing)
        top = _look_up(q + band, p_first, p_step, opening)
        if at_once and extra > 0.0:
            bottom = _jumps(e, bottom, held_bottom) if bottom > e else bottom
            top = _jumps(e, top, held_top) if top < e else top
        slipped = True
        e = max(stops[0], min(stops[1], max(bottom, min(top, e))))
        elements[j] = e
        w += plays[1][j] * e
    return w, slipped


@njit(cache=True, nogil=True, error_model="numpy")
def _half_band(wide: float, travelled: float, speed: float, c: FloatArray) -> float:
    """What is added to the half deadband now: what time added, wear, and friction that falls with speed."""
    grown: float = wide + c[V_WEAR] * travelled
    if c[V_STRIBECK] > 0.0:
        grown += c[V_STRIBECK] * np.exp(-speed / c[V_STRIBECK_SPEED])
    return grown


@njit(cache=True, nogil=True, error_model="numpy")
def _bounded(x: float, new: float, h: float, c: FloatArray, stops: FloatArray) -> float:
    """The stem after `h` seconds on its way from x to `new`, no faster than its rates and within its stops."""
    slow = max(x - c[V_RATE_OPEN] * h, min(x + c[V_RATE_CLOSE] * h, new))
    bounded: float = max(stops[2], min(stops[3], slow))
    return bounded


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
    start: tuple[float, float],
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem. `stops`: (low, high) of the play output, then of the stem; `start`: (x, w)."""
    elements = np.full(plays[0].size, start[1])
    w, _ = _play_step(force[0], widening[0], 0.0, False, stops, tables, plays, elements)
    x = max(stops[2], min(stops[3], start[0]))
    out[0] = x
    after, stuck, travelled, speed, last_h = w, True, 0.0, 0.0, -1.0
    lags = np.zeros((3, 2))
    at_once = c[V_STICK_SPEED] >= FOREVER
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h = h
            _decays(h, c, lags)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            grown = _half_band(widening[f if widening.size > 1 else 0], travelled, speed, c)
            if c[V_IN_MOTION] != 0.0:
                elements += c[V_IN_MOTION] * (x - w)
            extra = c[V_BREAKAWAY] if stuck else 0.0
            new_w, slipped = _play_step(force[f], grown, extra, at_once, stops, tables, plays, elements)
            new_after = _toward(after, w, new_w, lags[2])
            new = _bounded(x, _toward(x, after, new_after, lags[0 if after + new_after > 2.0 * x else 1]), h, c, stops)
            if c[V_HELD] > 0.0:
                slipped = abs(new_after - x) > c[V_HELD]
                new = x if stuck and not slipped else new
            speed = abs(new - x) / h
            stuck = (stuck and not slipped) or speed < c[V_STICK_SPEED]
            x, w, after, travelled = new, new_w, new_after, travelled + abs(new - x)
            out[f] = x
