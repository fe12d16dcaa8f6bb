"""A running mean: what a converter that integrates, or a filter that averages its last samples, makes of a signal."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray


def integral(t: FloatArray, values: FloatArray) -> FloatArray:
    """The integral of `values` from the first point on, shape of `t` [s]; linear between the points."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))])


def running_mean(t: FloatArray, values: FloatArray, window_s: float) -> FloatArray:
    """The mean of `values` over `window_s` [s] > 0 up to each `t`; before the first point they were as there."""
    whole = integral(t, values)
    earlier = t - window_s
    before = np.interp(earlier, t, whole) + values[0] * np.minimum(earlier - t[0], 0.0)
    return np.asarray((whole - before) / window_s)
