"""The stem compiled: a lag toward its target, bounded in speed and by the stops."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray

_SAME = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def stem_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    target: FloatArray,
    lags_s: FloatArray,
    rates: FloatArray,
    low: float,
    high: float,
    x0: float,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem; `lags_s`, `rates`: (closing, opening)."""
    x = max(low, min(high, x0))
    out[0] = x
    last_h = -1.0
    e_close = e_open = r_close = r_open = up = down = 0.0
    one_lag = lags_s[0] == lags_s[1]
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h = h
            e_close, r_close = np.exp(-h / max(lags_s[0], 1e-12)), lags_s[0] / h
            e_open, r_open = np.exp(-h / max(lags_s[1], 1e-12)), lags_s[1] / h
            up, down = rates[0] * h, rates[1] * h
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            w_a, w_b = target[f - 1], target[f]
            decay, reach = e_close, r_close
            if not one_lag and w_a + w_b <= 2.0 * x:
                decay, reach = e_open, r_open
            slope_tau = (w_b - w_a) * reach
            new = w_b - slope_tau + (x - w_a + slope_tau) * decay
            x = max(low, min(high, max(x - down, min(x + up, new))))
            out[f] = x
