"""The position sensor compiled: stem on the fine grid in, reading at the sample instants out.

Order of the parts: linkage play, curvature, gain and zero with drift, low-pass, refresh (hold), resolution.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    S_BOW,
    S_DRIFT_AMP,
    S_DRIFT_RATE,
    S_DRIFT_TAU_S,
    S_GAIN,
    S_HOLD_PHASE_S,
    S_HOLD_S,
    S_LAG_S,
    S_PLAY,
    S_STEP,
    S_SWING,
    S_TRAVEL,
    S_ZERO,
)


@njit(cache=True, nogil=True, error_model="numpy")
def _curve(x: float, t: float, c: FloatArray) -> float:
    """Static curve of the reading plus its drifting zero [position]."""
    xi = x / c[S_TRAVEL]
    y = x + c[S_TRAVEL] * xi * (1.0 - xi) * (4.0 * c[S_BOW] + 10.4 * c[S_SWING] * (1.0 - 2.0 * xi))
    y = c[S_GAIN] * y + c[S_ZERO] + c[S_DRIFT_RATE] * t
    if c[S_DRIFT_AMP] != 0.0:
        y += c[S_DRIFT_AMP] * (1.0 - np.exp(-t / c[S_DRIFT_TAU_S]))
    return y


@njit(cache=True, nogil=True, error_model="numpy")
def _refresh(time_s: FloatArray, c: FloatArray, out: FloatArray) -> None:
    """Holds the reading between refreshes at phase + n * period; the value is that of the refresh instant."""
    period = c[S_HOLD_S]
    source = out.copy()
    k = 0
    for i in range(time_s.size):
        t = time_s[i] - time_s[0]
        at = np.floor((t - c[S_HOLD_PHASE_S]) / period) * period + c[S_HOLD_PHASE_S]
        while k + 1 < time_s.size and time_s[k + 1] - time_s[0] <= at:
            k += 1
        if at <= 0.0 or k + 1 >= time_s.size:
            out[i] = source[k]
            continue
        share = (at - (time_s[k] - time_s[0])) / (time_s[k + 1] - time_s[k])
        out[i] = source[k] + share * (source[k + 1] - source[k])


@njit(cache=True, nogil=True, error_model="numpy")
def sensor_kernel(time_s: FloatArray, stem: FloatArray, offsets: np.ndarray, c: FloatArray, out: FloatArray) -> None:
    """Fills `out` (shape (n,)) with the reading."""
    half = 0.5 * c[S_PLAY]
    core = stem[0]
    y_a = _curve(core, 0.0, c)
    lagged = y_a
    out[0] = y_a
    f = 0
    for i in range(1, time_s.size):
        m = offsets[i] - offsets[i - 1]
        h = (time_s[i] - time_s[i - 1]) / m
        for s in range(m):
            f += 1
            x = stem[f]
            core = max(x - half, min(x + half, core)) if half > 0.0 else x
            y_b = _curve(core, time_s[i - 1] + (s + 1) * h - time_s[0], c)
            if c[S_LAG_S] > 0.0:
                e = np.exp(-h / c[S_LAG_S])
                slope = (y_b - y_a) / h * c[S_LAG_S]
                lagged = y_b - slope + (lagged - y_a + slope) * e
            else:
                lagged = y_b
            y_a = y_b
        out[i] = lagged
    if c[S_HOLD_S] > 0.0:
        _refresh(time_s, c, out)
    if c[S_STEP] > 0.0:
        for i in range(time_s.size):
            out[i] = np.round(out[i] / c[S_STEP]) * c[S_STEP]
