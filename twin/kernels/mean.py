"""A running mean: what a converter that integrates, or a filter that averages its last samples, makes of a signal.

Exact for a signal that is linear between the points, however short the window is.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray

#: Over so short a time [s] nothing is averaged; the difference of two integrals would be rounding errors.
SHORTEST_S = 1e-5


def integral(t: FloatArray, values: FloatArray) -> FloatArray:
    """The integral of `values` from the first point on, shape of `t` [s]."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))])


def integral_at(t: FloatArray, values: FloatArray, whole: FloatArray, at: FloatArray) -> FloatArray:
    """The integral `whole` at the times `at`; before the first point the values were as they are there."""
    k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, t.size - 2)
    into = at - t[k]
    slope = np.where(into > 0.0, (values[k + 1] - values[k]) / np.maximum(t[k + 1] - t[k], 1e-12), 0.0)
    return np.asarray(whole[k] + into * (values[k] + 0.5 * slope * into))


def running_mean(t: FloatArray, values: FloatArray, window_s: float) -> FloatArray:
    """The mean of `values` over `window_s` [s] up to each `t`; before the first point they were as there."""
    if window_s <= SHORTEST_S or t.size < 2:
        return values
    whole = integral(t, values)
    return np.asarray((whole - integral_at(t, values, whole, t - window_s)) / window_s)
