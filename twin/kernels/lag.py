"""A first-order lag compiled, exact for an input that is linear within each fine step."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray

#: Two step lengths that differ by less than this fraction share their decay factors.
_SAME = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def lag_pass(time_s: FloatArray, offsets: np.ndarray, values: FloatArray, tau_s: float, out: FloatArray) -> None:
    """Fills `out` with `values` (both fine, shape (n_fine,)) lagged by `tau_s` > 0; at rest at the first point."""
    y = values[0]
    out[0] = y
    last_h = -1.0
    decay = 0.0
    reach = 0.0
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h = h
            decay = np.exp(-h / tau_s)
            reach = tau_s / h
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            slope_tau = (values[f] - values[f - 1]) * reach
            y = values[f] - slope_tau + (y - values[f - 1] + slope_tau) * decay
            out[f] = y


@njit(cache=True, nogil=True, error_model="numpy")
def _fine_time(time_s: FloatArray, offsets: np.ndarray, out: FloatArray) -> None:
    out[0] = 0.0
    for i in range(1, time_s.size):
        h = (time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1])
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            out[f] = time_s[i - 1] - time_s[0] + (f - offsets[i - 1]) * h


def elapsed_s(time_s: FloatArray, offsets: np.ndarray) -> FloatArray:
    """Seconds since the first row at every fine point, shape (n_fine,)."""
    out = np.empty(int(offsets[-1]) + 1)
    _fine_time(time_s, offsets, out)
    return out


def lagged(time_s: FloatArray, offsets: np.ndarray, values: FloatArray, tau_s: float) -> FloatArray:
    """`values` on the fine grid through a lag of `tau_s` [s]; a lag of none returns them as they are."""
    if tau_s <= 1e-9:
        return values
    out = np.empty_like(values)
    lag_pass(time_s, offsets, values, tau_s, out)
    return out
