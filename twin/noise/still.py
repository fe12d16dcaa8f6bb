"""Stretches where a signal rests, or moves evenly, and the fastest part of it everywhere: noise without repeats.

A stretch is judged in windows of 2.5 s and at least 20 samples about a parabola; windows that follow each other are
joined. Slow settling and creep inside a stretch go with the parabola.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter
from scipy.signal import lfilter

from logs.recording import FloatArray
from twin.noise.robust import robust_sigma

IntArray = npt.NDArray[np.int64]

_WINDOW_S = 2.5
_STRETCH_S = 60.0  # longer stretches are cut: over minutes creep is no parabola any more
_TREND_SIGMAS = 3.0
_FAST_RATIO = 5.0  # noise with a memory of ten samples is four times louder than its fast part; motion is more
_STRAIGHT = 5e-4  # of the command's range
_BLOCK, _QUARTILE = 6, 0.67  # the lower quartile of the RMS of six second differences of white noise of sigma 1
_MOST = 200_000  # rows for the memory of the fast part
_PLAIN = 1.5  # windows louder than this over the quieter third hold a corner or a slip


def window_rows(period_s: float) -> int:
    return max(20, round(_WINDOW_S / period_s))


def held_windows(time_s: FloatArray, command: FloatArray) -> IntArray:
    """First rows of the windows in which the command is constant.

    Windows are counted back from the end of each hold, where the signal has settled most.
    """
    period = float(np.median(np.diff(time_s)))
    width = window_rows(period)
    changes = np.abs(np.diff(command)) > 1e-6 * max(float(np.ptp(command)), 1e-12)
    breaks = np.flatnonzero(changes | (np.diff(time_s) > 3.0 * period)) + 1
    edges = np.concatenate([[0], breaks, [time_s.size]])
    long = np.flatnonzero(np.diff(edges) >= width)
    # never from a hold's first row on: windows of two holds must not touch and be joined
    starts = [np.arange(edges[i + 1] - width, edges[i], -width)[::-1] for i in long]
    return np.concatenate([np.zeros(0, dtype=np.int64), *starts])


def straight_windows(time_s: FloatArray, command: FloatArray) -> IntArray:
    """First rows of the windows in which the command goes along a line; they do not touch, for slopes differ."""
    width = window_rows(float(np.median(np.diff(time_s))))
    starts = np.arange(0, command.size - width + 1, width + 1, dtype=np.int64)
    if starts.size == 0:
        return starts
    windows = command[starts[:, None] + np.arange(width)]
    line = _parabola(width)[:, :2]
    off = np.abs(windows - windows @ line @ line.T).max(axis=1)
    return np.asarray(starts[off <= _STRAIGHT * max(float(np.ptp(command)), 1e-12)])


def even_windows(rows: int, period_s: float) -> IntArray:
    """First rows of windows side by side, whatever the command."""
    width = window_rows(period_s)
    return np.arange(0, rows - width + 1, width, dtype=np.int64)


def still_pieces(signal: FloatArray, period_s: float, starts: IntArray, still: bool = True) -> list[FloatArray]:
    """Residuals about a parabola of those windows in which the signal stands still, joined where they touch.

    A window is still when its parabola moves by no more than 3 sigma of the window's residual. Unless `still` is asked
    for, it may move, and windows much louder than the quiet ones are left out instead.
    """
    if starts.size == 0:
        return []
    width = window_rows(period_s)
    fast = fast_sigma(signal)
    calm = _without_outliers(_filled(signal), 6.0 * fast)
    windows = calm[starts[:, None] + np.arange(width)]
    basis = _parabola(width)
    fitted = windows @ basis @ basis.T
    spread = _spread(windows - fitted)
    good = np.isfinite(signal)[starts[:, None] + np.arange(width)].mean(axis=1) > 0.9
    good &= spread <= _FAST_RATIO * fast
    if still:
        good &= np.ptp(fitted, axis=1) <= _TREND_SIGMAS * spread
    elif good.any():
        good &= spread <= _PLAIN * float(np.quantile(spread[good], 0.3))
    longest = max(1, round(_STRETCH_S / (width * period_s)))
    return [_detrended(signal[a:b], calm[a:b]) for a, b in _joined(starts[good], width, longest)]


def fast_sigma(signal: FloatArray) -> float:
    """Sigma of white noise from second differences: motion smooth over three samples cancels, slow noise does too.

    Where motion fills most of the record, its quieter stretches speak for it.
    """
    if signal.size < 3:
        return 0.0
    second = np.diff(signal, 2)
    count = second.size // _BLOCK
    whole = robust_sigma(second) / np.sqrt(6.0)
    if count < 10:
        return float(whole)
    blocks = np.sqrt(np.mean(np.square(np.nan_to_num(second[: count * _BLOCK])).reshape(count, _BLOCK), axis=1) / 6.0)
    return float(min(whole, np.quantile(blocks, 0.25) / _QUARTILE) or whole)


def fast_memory(signal: FloatArray) -> tuple[float, float]:
    """Sigma and lag-one correlation of noise with a short memory, from second differences over growing spans.

    Their variance levels off for noise and grows with the fourth power of the span for motion: the last span before
    that growth holds the noise. Correlation 0 where the first span grows already.
    """
    signal = signal[:_MOST]
    first = level = fast_sigma(signal)
    for span in (2, 4, 8, 16):
        wider = fast_sigma_at(signal, span)
        if not 0.0 < wider < 1.5 * level:  # noise grows by 1.41 at most, motion four times
            break
        level = max(level, wider)
    ratio = min(1.0, (first / level) ** 2) if level > 0 else 1.0
    # for a first-order memory phi: (first / level)^2 = 1 - (4 phi - phi^2) / 3
    phi = 2.0 - float(np.sqrt(4.0 - 3.0 * (1.0 - ratio)))
    return level, phi


def fast_sigma_at(signal: FloatArray, span: int) -> float:
    """`fast_sigma` of every `span`-th sample, the median over the ways to take them."""
    return float(np.median([fast_sigma(signal[k::span]) for k in range(span)]))


def given_back(rho: FloatArray, sizes: Sequence[int]) -> tuple[FloatArray, float]:
    """The correlation, and the factor on sigma, with what the parabolas took from the noise given back.

    A parabola takes the slow part, more of it the longer the noise's memory. How much is worked out for a first-order
    memory whose residual has the measured correlation at lag one, on pieces of the mean size; a memory as long as the
    pieces cannot be told from their parabola, so the factor ends at 1.3.
    """
    size = int(np.mean(sizes))  # what is taken goes with the number of pieces per row
    if rho.size < 2 or size < 8:
        return rho, 1.0
    phis = np.linspace(0.0, 0.95, 60)
    left = [_left_of_memory(float(phi), size, 1) for phi in phis]
    keep = [c[0] > (1.0 - 3.0 / size) / 1.3**2 for c in left]
    phis, left = phis[keep], [c for c, kept in zip(left, keep, strict=True) if kept]
    phi = float(np.interp(rho[1], [c[1] / c[0] for c in left], phis))
    after = _left_of_memory(phi, size, rho.size - 1)
    before = phi ** np.arange(rho.size)
    before[0] = 1.0
    mended = np.concatenate([[1.0], (rho * after[0] + before - after)[1:]])
    # the pieces come with the variance given back that a parabola takes from white noise
    return mended, float(np.sqrt((1.0 - 3.0 / size) / after[0]))


def _left_of_memory(phi: float, size: int, lags: int) -> FloatArray:
    """Expected lag products of noise of variance 1 and correlation phi^lag about its parabola, lags 0..`lags`."""
    basis = _parabola(size)
    ahead = lfilter([1.0], [1.0, -phi], basis, axis=0)
    behind = lfilter([1.0], [1.0, -phi], basis[::-1], axis=0)[::-1]
    spread = ahead + behind - basis  # the noise's covariance times the basis
    inner = basis @ (basis.T @ spread)
    left = np.zeros(lags + 1)
    for lag in range(min(lags, size - 1) + 1):
        early, late = slice(0, size - lag), slice(lag, size)
        crossed = np.sum(spread[early] * basis[late]) + np.sum(basis[early] * spread[late])
        left[lag] = phi**lag - (crossed - np.sum(inner[early] * basis[late])) / (size - lag)
    return left


@lru_cache(maxsize=64)
def _parabola(size: int) -> FloatArray:
    """Orthonormal basis of the parabolas on `size` samples, shape (size, 3)."""
    x = np.linspace(-1.0, 1.0, size)
    return np.asarray(np.linalg.qr(np.stack([np.ones(size), x, x * x], axis=1))[0])


def _spread(windows: FloatArray) -> FloatArray:
    """A robust sigma of each row; where most of a row sits on one quantization step, the mean deviation's."""
    deviation = np.abs(windows)
    middle = 1.4826 * np.median(deviation, axis=1)
    return np.where(middle > 0.0, middle, 1.2533 * deviation.mean(axis=1))


def _detrended(piece: FloatArray, calm: FloatArray) -> FloatArray:
    """The piece less the parabola of its calm version, with the variance that takes from white noise given back."""
    basis = _parabola(piece.size)
    return np.asarray((piece - basis @ (basis.T @ calm)) * np.sqrt(piece.size / (piece.size - 3.0)))


def _without_outliers(signal: FloatArray, bound: float) -> FloatArray:
    """The signal with what is further than `bound` from the median of five samples set to that median."""
    middle = median_filter(signal, 5, mode="nearest")
    return np.where(np.abs(signal - middle) > bound, middle, signal)


def _filled(signal: FloatArray) -> FloatArray:
    """The signal with missing samples interpolated."""
    known = np.isfinite(signal)
    if known.all() or not known.any():
        return signal
    rows = np.arange(signal.size)
    return np.interp(rows, rows[known], signal[known])


def _joined(starts: IntArray, width: int, longest: int) -> list[tuple[int, int]]:
    """Half-open row ranges of windows that touch, none of more than `longest` windows."""
    if starts.size == 0:
        return []
    cuts = np.flatnonzero(np.diff(starts) != width) + 1
    ranges: list[tuple[int, int]] = []
    for run in np.split(starts, cuts):
        ranges += [(int(run[i]), int(run[min(i + longest, run.size) - 1]) + width) for i in range(0, run.size, longest)]
    return ranges
