"""The valve compiled: pressure on the fine grid in, true stem position on the fine grid out.

The two backlash curves arrive as tables over a uniform pressure grid, so that every effect which bends them (spring,
friction spot, flow force) costs nothing here. Play elements may be several (distributed hysteresis). The lag is solved
exactly for a play output that is linear within a fine step.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    V_BREAKAWAY,
    V_CREEP1,
    V_CREEP1_TAU_S,
    V_CREEP2,
    V_CREEP2_TAU_S,
    V_DRIFT_AMP,
    V_DRIFT_RATE,
    V_DRIFT_TAU_S,
    V_HIGH,
    V_IN_MOTION,
    V_LOW,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_STEP,
    V_STEP_TIME_S,
    V_STICK_SPEED,
    V_TAU_AFTER_S,
    V_TAU_BEFORE_S,
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
    e = np.exp(-h / tau_s)
    slope_tau = (w_b - w_a) / h * tau_s
    return w_b - slope_tau + (x - w_a + slope_tau) * e


@njit(cache=True, nogil=True, error_model="numpy")
def _half_band(t: float, travelled: float, c: FloatArray) -> float:
    """How much wider the half deadband is now than at the start [pressure]."""
    grown = c[V_DRIFT_RATE] * t + c[V_WEAR] * travelled
    if c[V_DRIFT_AMP] != 0.0:
        grown += c[V_DRIFT_AMP] * (1.0 - np.exp(-t / c[V_DRIFT_TAU_S]))
    if t >= c[V_STEP_TIME_S]:
        grown += c[V_STEP]
    return grown


@njit(cache=True, nogil=True, error_model="numpy")
def valve_kernel(
    time_s: FloatArray,
    pressure: FloatArray,
    offsets: np.ndarray,
    c: FloatArray,
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
    """Fills `out` with the stem position. `spreads[j]` widens the half deadband of play element j [pressure]."""
    plays = spreads.size
    elements = np.empty(plays)
    low = c[V_LOW]
    high = c[V_HIGH]
    q = pressure[0]
    for j in range(plays):
        top = _look_up(q + spreads[j], p_first, p_step, opening)
        bottom = _look_up(q - spreads[j], p_first, p_step, closing)
        elements[j] = max(low, min(high, max(bottom, min(top, w0))))
    w = 0.0
    for j in range(plays):
        w += weights[j] * elements[j]
    x = max(low, min(high, x0))
    after = w
    creep1 = x
    creep2 = x
    stuck = True
    travelled = 0.0
    out[0] = x
    f = 0
    for i in range(1, time_s.size):
        m = offsets[i] - offsets[i - 1]
        h = (time_s[i] - time_s[i - 1]) / m
        for s in range(m):
            p_a = pressure[f]
            f += 1
            q = _ramp_lag(q, p_a, pressure[f], h, c[V_TAU_BEFORE_S]) if c[V_TAU_BEFORE_S] > 0.0 else pressure[f]
            t = time_s[i - 1] + (s + 1) * h - time_s[0]
            grown = _half_band(t, travelled, c)
            if c[V_IN_MOTION] != 0.0:
                shift = x - w
                for j in range(plays):
                    elements[j] += c[V_IN_MOTION] * shift
                w += c[V_IN_MOTION] * shift
            extra = c[V_BREAKAWAY] if stuck else 0.0
            w_b = 0.0
            for j in range(plays):
                e = elements[j]
                band = spreads[j] + grown
                if extra > 0.0:
                    low_j = _look_up(q - band - extra, p_first, p_step, closing)
                    high_j = _look_up(q + band + extra, p_first, p_step, opening)
                    if low_j <= e <= high_j:
                        w_b += weights[j] * e
                        continue
                    stuck = False
                low_j = _look_up(q - band, p_first, p_step, closing)
                high_j = _look_up(q + band, p_first, p_step, opening)
                e = max(low, min(high, max(low_j, min(high_j, e))))
                elements[j] = e
                w_b += weights[j] * e
            new_after = _ramp_lag(after, w, w_b, h, c[V_TAU_AFTER_S])
            closing_now = new_after + after > 2.0 * x
            new_x = _ramp_lag(x, after, new_after, h, c[V_TAU_CLOSE_S] if closing_now else c[V_TAU_OPEN_S])
            new_x = max(x - c[V_RATE_OPEN] * h, min(x + c[V_RATE_CLOSE] * h, new_x))
            new_x = max(low, min(high, new_x))
            if abs(new_x - x) < c[V_STICK_SPEED] * h:
                stuck = True
            travelled += abs(new_x - x)
            y = new_x
            if c[V_CREEP1] != 0.0 or c[V_CREEP2] != 0.0:
                creep1 = _ramp_lag(creep1, x, new_x, h, c[V_CREEP1_TAU_S])
                creep2 = _ramp_lag(creep2, x, new_x, h, c[V_CREEP2_TAU_S])
                y += c[V_CREEP1] * (creep1 - new_x) + c[V_CREEP2] * (creep2 - new_x)
            x = new_x
            after = new_after
            w = w_b
            out[f] = y
