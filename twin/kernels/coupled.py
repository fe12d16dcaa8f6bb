"""Play and stem in one loop, for effects in which the target depends on how the stem moves.

Friction inside the force balance, breakaway with a stick speed, friction that falls with speed, wear with distance.
The small functions stand here once more on purpose: a compiled cache notices edits of its own file only.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    V_BREAKAWAY,
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


@njit(cache=True, nogil=True, error_model="numpy")
def _look_up(p: float, p_first: float, p_step: float, table: FloatArray) -> float:
    """Linear interpolation in a uniform table, extended by its end slopes."""
    q = (p - p_first) / p_step
    i = min(max(int(q), 0), table.size - 2)
    return table[i] + (q - i) * (table[i + 1] - table[i])


@njit(cache=True, nogil=True, error_model="numpy")
def _ramp_lag(x: float, w_a: float, w_b: float, h: float, tau_s: float) -> float:
    """Exact step of tau x' = w - x for w linear from w_a to w_b over h seconds."""
    if tau_s <= 1e-9:
        return w_b
    slope_tau = (w_b - w_a) / h * tau_s
    return w_b - slope_tau + (x - w_a + slope_tau) * np.exp(-h / tau_s)


@njit(cache=True, nogil=True, error_model="numpy")
def _play_step(
    q: float,
    grown: float,
    extra: float,
    stops: FloatArray,
    p_first: float,
    p_step: float,
    closing: FloatArray,
    opening: FloatArray,
    spreads: FloatArray,
    weights: FloatArray,
    elements: FloatArray,
) -> tuple[float, bool]:
    """Moves the elements to pressure `q`; those that `extra` holds stay. Returns their sum and whether any slipped."""
    w = 0.0
    slipped = False
    for j in range(spreads.size):
        e = elements[j]
        band = spreads[j] + grown
        if extra > 0.0:
            bottom = _look_up(q - band - extra, p_first, p_step, closing)
            top = _look_up(q + band + extra, p_first, p_step, opening)
            if bottom <= e <= top:
                w += weights[j] * e
                continue
        slipped = True
        bottom = _look_up(q - band, p_first, p_step, closing)
        top = _look_up(q + band, p_first, p_step, opening)
        e = max(stops[0], min(stops[1], max(bottom, min(top, e))))
        elements[j] = e
        w += weights[j] * e
    return w, slipped


@njit(cache=True, nogil=True, error_model="numpy")
def _stem_step(x: float, w_a: float, w_b: float, h: float, c: FloatArray, low: float, high: float) -> float:
    """One step of the stem toward a target that goes from w_a to w_b."""
    tau_s = c[V_TAU_CLOSE_S] if w_a + w_b > 2.0 * x else c[V_TAU_OPEN_S]
    new = _ramp_lag(x, w_a, w_b, h, tau_s)
    return max(low, min(high, max(x - c[V_RATE_OPEN] * h, min(x + c[V_RATE_CLOSE] * h, new))))


@njit(cache=True, nogil=True, error_model="numpy")
def coupled_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    stops: FloatArray,
    p_first: float,
    p_step: float,
    closing: FloatArray,
    opening: FloatArray,
    spreads: FloatArray,
    weights: FloatArray,
    x0: float,
    w0: float,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem. `stops` is (low, high) of the play output, then of the stem."""
    elements = np.full(spreads.size, w0)
    w, _ = _play_step(force[0], widening[0], 0.0, stops, p_first, p_step, closing, opening, spreads, weights, elements)
    x = max(stops[2], min(stops[3], x0))
    after = w
    stuck, travelled, speed = True, 0.0, 0.0
    out[0] = x
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            grown = widening[f if widening.size > 1 else 0] + c[V_WEAR] * travelled
            if c[V_STRIBECK] > 0.0:
                grown += c[V_STRIBECK] * np.exp(-speed / c[V_STRIBECK_SPEED])
            if c[V_IN_MOTION] != 0.0:
                elements += c[V_IN_MOTION] * (x - w)
            extra = c[V_BREAKAWAY] if stuck else 0.0
            new_w, slipped = _play_step(
                force[f], grown, extra, stops, p_first, p_step, closing, opening, spreads, weights, elements
            )
            new_after = _ramp_lag(after, w, new_w, h, c[V_TAU_AFTER_S])
            new = _stem_step(x, after, new_after, h, c, stops[2], stops[3])
            speed = abs(new - x) / h
            stuck = (stuck and not slipped) or speed < c[V_STICK_SPEED]
            travelled += abs(new - x)
            x, w, after = new, new_w, new_after
            out[f] = x
