"""What can be said of readings before any model: how noisy they are, and which of them are plainly false."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

FALSE_NOISES = 12.0
FALSE_REACH = 0.02  # of the range of the middle 98 %: a false reading is at least so far off


def fast_noise(values: FloatArray) -> float:
    """Standard deviation of what changes from reading to reading, steady motion and outliers aside. NaN is left out."""
    bends = np.diff(values[np.isfinite(values)], n=2)
    return float(1.4826 * np.median(np.abs(bends)) / np.sqrt(6.0)) if bends.size else 0.0


def false_readings(values: FloatArray) -> npt.NDArray[np.bool_]:
    """Readings far from the median of the five around them, shape (n,): one or two in a row that nothing can explain.

    Where the signal moves fast, as much more is allowed as it moves within five readings.
    """
    finite = np.isfinite(values)
    false = np.zeros(values.size, dtype=bool)
    inside = values[finite]
    if inside.size < 20:
        return false
    padded = np.pad(inside, 2, mode="reflect")
    around = np.lib.stride_tricks.sliding_window_view(padded, 5)
    middle = np.median(around, axis=1)
    low, high = np.percentile(inside, (1.0, 99.0))
    least = max(FALSE_NOISES * fast_noise(inside), FALSE_REACH * float(high - low))
    spread = np.sort(np.abs(around - middle[:, None]), axis=1)[:, 2]  # how far three of the five lie apart
    false[finite] = np.abs(inside - middle) > least + 6.0 * spread
    return false
