"""A filter of second order, compiled: a mass on a spring, or a filter with two poles that are not alike.

Exact for an input that is linear within each fine step. Source: Franklin, Powell, Emami-Naeini, Feedback Control of
Dynamic Systems, ch. 3 (response of second order).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray

#: A filter that is quicker follows at once [s].
_NONE_S = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def second_order_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    values: FloatArray,
    natural_s: float,
    damping: float,
    state: FloatArray,
    out: FloatArray,
) -> None:
    """Fills `out` with `values` (both fine, shape (n_fine,)) behind the filter, and moves `state` (value, slope) on.

    `natural_s`: 1 / natural frequency; `damping`: ratio, below 1.
    """
    y, slope = state[0], state[1]
    out[0] = y
    decay, turns = damping / natural_s, np.sqrt(1.0 - damping * damping) / natural_s
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        less, sine, cosine = np.exp(-decay * h), np.sin(turns * h), np.cos(turns * h)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            rise = (values[f] - values[f - 1]) / h
            behind = 2.0 * damping * natural_s * rise
            off, speed = y - values[f - 1] + behind, slope - rise
            y = values[f] - behind + less * (off * cosine + (speed + decay * off) / turns * sine)
            slope = rise + less * (speed * cosine - (decay * speed + off / natural_s**2) / turns * sine)
            out[f] = y
    state[0], state[1] = y, slope


def swinging(
    time_s: FloatArray, offsets: np.ndarray, values: FloatArray, natural_s: float, damping: float
) -> FloatArray:
    """`values` on the fine grid behind the filter, at rest at the first point; without a filter as they are."""
    if natural_s <= _NONE_S:
        return values
    out = np.empty_like(values)
    second_order_pass(time_s, offsets, values, natural_s, damping, np.array([values[0], 0.0]), out)
    return out
