"""The stem behind a damper whose check valve opens above a speed: from there on each way has a lag of its own.

Beyond the speed v the pull (target - stem) / lag makes a stem faster, by 1 + `eases` times what it is above v. That is
a lag 1 + eases times as short toward a target that is nearer, and of both laws the faster one holds.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray

_SAME = 1e-9


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _toward(x: float, w_a: float, w_b: float, lag: tuple[float, float]) -> float:
    """Exact step of a lag (decay, lag over the step) for an input linear from w_a to w_b."""
    slope_tau = (w_b - w_a) * lag[1]
    new: float = w_b - slope_tau + (x - w_a + slope_tau) * lag[0]
    return new


@njit(cache=True, nogil=True, error_model="numpy")
def _lag(h: float, lag_s: float, eases: float) -> tuple[float, float]:
    """Decay over `h` of a lag that is 1 + eases times as short, and that lag over h."""
    reach = max(lag_s, 1e-12) / (h * (1.0 + eases))
    return np.exp(-1.0 / reach), reach


@njit(cache=True, nogil=True, error_model="numpy")
def eased_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    target: FloatArray,
    lags_s: FloatArray,
    rates: FloatArray,
    stops: tuple[float, float],
    eases: tuple[float, float, float],
    x0: float,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem; `lags_s`, `rates`: (closing, opening), `eases`: for each way, above a speed."""
    x = max(stops[0], min(stops[1], x0))
    out[0], last_h = x, -1.0
    # how much nearer the target is of what is above that speed
    up = eases[2] * lags_s[0] * eases[0] / (1.0 + eases[0])
    down = eases[2] * lags_s[1] * eases[1] / (1.0 + eases[1])
    close, opens, quick_close, quick_open = ((1.0, 1.0),) * 4
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h, close, opens = h, _lag(h, lags_s[0], 0.0), _lag(h, lags_s[1], 0.0)
            quick_close, quick_open = _lag(h, lags_s[0], eases[0]), _lag(h, lags_s[1], eases[1])
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            a, b = target[f - 1], target[f]
            if a + b > 2.0 * x:
                new = max(_toward(x, a, b, close), _toward(x, a - up, b - up, quick_close))
            else:
                new = min(_toward(x, a, b, opens), _toward(x, a + down, b + down, quick_open))
            x = max(stops[0], min(stops[1], max(x - rates[1] * h, min(x + rates[0] * h, new))))
            out[f] = x
