"""Stretches where a signal does not move, and the fastest part of it everywhere: noise without repeats."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from logs.recording import FloatArray
from twin.noise.robust import robust_sigma

_WINDOW_S = 5.0
_STRETCH_S = 60.0  # longer stretches are cut: over minutes creep is no parabola any more
_TREND_SIGMAS = 3.0


def fast_sigma(signal: FloatArray) -> float:
    """Sigma of white noise from second differences: motion smooth over three samples cancels, slow noise does too."""
    if signal.size < 3:
        return 0.0
    return float(robust_sigma(np.diff(signal, 2)) / np.sqrt(6.0))


def still_pieces(signal: FloatArray, period_s: float, command: FloatArray | None = None) -> list[FloatArray]:
    """Residuals about a parabola of the stretches where the signal stands still, each at least 5 s and 20 samples.

    A window is still when its parabola moves by no more than 3 sigma of the window's residual, and, with `command`,
    when that is constant. Slow settling and creep inside a still stretch are taken out by the parabola.
    """
    width = max(20, round(_WINDOW_S / period_s))
    count = signal.size // width
    if count == 0:
        return []
    windows = _filled(signal)[: count * width].reshape(count, width)
    basis = _parabola(width)
    fitted = windows @ basis @ basis.T
    spread = _spread(windows - fitted)
    still = np.ptp(fitted, axis=1) <= _TREND_SIGMAS * spread
    still &= np.isfinite(signal[: count * width]).reshape(count, width).mean(axis=1) > 0.9
    if command is not None:
        held = command[: count * width].reshape(count, width)
        still &= np.ptp(held, axis=1) <= 1e-6 * max(float(np.ptp(command)), 1e-12)
    longest = max(1, round(_STRETCH_S / (width * period_s)))
    bound = 5.0 * fast_sigma(signal)
    return [_detrended(signal[a * width : b * width], bound) for a, b in _runs(still, longest)]


def _spread(windows: FloatArray) -> FloatArray:
    """A robust sigma of each row; where most of a row sits on one quantization step, the mean deviation's."""
    deviation = np.abs(windows)
    middle = 1.4826 * np.median(deviation, axis=1)
    return np.where(middle > 0.0, middle, 1.2533 * deviation.mean(axis=1))


def _detrended(piece: FloatArray, bound: float) -> FloatArray:
    """The piece less its parabola, with the variance the parabola took given back; missing values stay NaN.

    Values further than `bound` from the running level do not pull the parabola.
    """
    basis = _parabola(piece.size)
    values = _filled(piece)
    middle = np.median(values)
    # a parabola through an outlier would spread it over the stretch: hold the values near their running level first
    level = basis @ (basis.T @ (values - middle)) + middle
    tame = level + np.clip(values - level, -bound, bound)
    residual = values - basis @ (basis.T @ tame)
    return np.where(np.isfinite(piece), residual * np.sqrt(piece.size / (piece.size - 3.0)), np.nan)


def taken_by_parabola(pieces: Sequence[FloatArray], lags: int) -> FloatArray:
    """What the parabolas took from the summed lag products of white noise of variance 1, per lag 0..`lags`."""
    sizes = Counter(piece.size for piece in pieces)
    return np.asarray(np.sum([count * _projected(size, lags) for size, count in sizes.items()], axis=0))


def _projected(size: int, lags: int) -> FloatArray:
    basis = _parabola(size)
    reach = min(lags, size - 1)
    products = [float(np.sum(basis[: size - lag] * basis[lag:])) for lag in range(reach + 1)]
    return np.asarray(np.pad(products, (0, lags - reach)))


@lru_cache(maxsize=64)
def _parabola(size: int) -> FloatArray:
    """Orthonormal basis of the parabolas on `size` samples, shape (size, 3)."""
    x = np.linspace(-1.0, 1.0, size)
    return np.asarray(np.linalg.qr(np.stack([np.ones(size), x, x * x], axis=1))[0])


def _filled(signal: FloatArray) -> FloatArray:
    """The signal with missing samples interpolated."""
    known = np.isfinite(signal)
    if known.all() or not known.any():
        return signal
    rows = np.arange(signal.size)
    return np.interp(rows, rows[known], signal[known])


def _runs(flags: np.ndarray, longest: int) -> list[tuple[int, int]]:
    """Half-open index ranges of consecutive True, none longer than `longest`."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    ranges: list[tuple[int, int]] = []
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        ranges += [(i, min(i + longest, int(stop))) for i in range(int(start), int(stop), longest)]
    return ranges
