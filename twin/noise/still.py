"""Stretches where a signal rests, or moves evenly: noise without repeats.

A stretch is judged in windows of 2.5 s and at least 20 samples about a parabola; windows that follow each other are
joined. Slow settling and creep inside a stretch go with the parabola. Missing readings have no weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter
from scipy.signal import lfilter

from logs.recording import FloatArray
from twin.noise.fast import fast_sigma

IntArray = npt.NDArray[np.int64]

_WINDOW_S = 2.5
_STRETCH_S = 60.0  # longer stretches are cut: over minutes creep is no parabola any more
_TREND_SIGMAS = 3.0
_FAST_RATIO = 5.0  # noise with a memory of ten samples is four times louder than its fast part; motion is more
_STRAIGHT = 5e-4  # of the command's range
_PLAIN = 1.5  # windows louder than this over the quieter third hold a corner or a slip
_FEWEST, _HOLE = 8, 3  # readings that a window must have; a hole of more than this part (1/n) of it says nothing


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
    line = parabola(width)[:, :2]
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
    return [piece for _, piece in still_stretches(signal, period_s, starts, still)]


def still_stretches(
    signal: FloatArray, period_s: float, starts: IntArray, still: bool = True
) -> list[tuple[tuple[int, int], FloatArray]]:
    """The pieces of `still_pieces`, each with its rows [a, b)."""
    if starts.size == 0:
        return []
    width = window_rows(period_s)
    fast = fast_sigma(signal)
    calm = _without_outliers(signal, 6.0 * fast)
    windows = calm[starts[:, None] + np.arange(width)]
    good = _enough(np.isfinite(windows))
    starts, windows = starts[good], windows[good]
    fitted, spread = _about_parabolas(windows)
    good = spread <= _FAST_RATIO * fast
    if still:
        good &= np.ptp(fitted, axis=1) <= _TREND_SIGMAS * spread
    elif good.any():
        good &= spread <= _PLAIN * float(np.quantile(spread[good], 0.3))
    longest = max(1, round(_STRETCH_S / (width * period_s)))
    rows = _joined(starts[good], width, longest)
    return [((a, b), _detrended(signal[a:b], calm[a:b])) for a, b in rows]


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
    basis = parabola(size)
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
def parabola(size: int) -> FloatArray:
    """Orthonormal basis of the parabolas on `size` samples, shape (size, 3)."""
    x = np.linspace(-1.0, 1.0, size)
    return np.asarray(np.linalg.qr(np.stack([np.ones(size), x, x * x], axis=1))[0])


def _enough(seen: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Which windows, shape (n, rows), have the readings for a parabola, and no hole in which it could go anywhere."""
    width = seen.shape[1]
    hole = width // _HOLE + 1
    whole = np.concatenate([np.zeros((seen.shape[0], 1)), np.cumsum(seen, axis=1)], axis=1)
    fewest_in_hole = (whole[:, hole:] - whole[:, :-hole]).min(axis=1)
    return np.asarray((whole[:, -1] >= _FEWEST) & (fewest_in_hole > 0))


def _about_parabolas(windows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The parabola of each window, shape (n, rows), and a robust sigma about it, shape (n,)."""
    basis = parabola(windows.shape[1])
    fitted = windows @ basis @ basis.T
    seen = np.isfinite(windows)
    lacking = ~seen.all(axis=1)
    if not lacking.any():
        return fitted, _spread(windows - fitted)
    weight, read = seen[lacking].astype(np.float64), np.where(seen, windows, 0.0)[lacking]
    normal = np.einsum("kr,ri,rj->kij", weight, basis, basis)
    fitted[lacking] = np.linalg.solve(normal, (read @ basis)[..., None])[..., 0] @ basis.T
    # of fewer readings the parabola takes more: they get as much back as a window has that lacks none
    taken = (1.0 - 3.0 / windows.shape[1]) / (1.0 - 3.0 / seen.sum(axis=1))
    return fitted, _spread(windows - fitted) * np.where(lacking, np.sqrt(taken), 1.0)


def _spread(windows: FloatArray) -> FloatArray:
    """A robust sigma of each row; where most of a row sits on one quantization step, the mean deviation's."""
    deviation = np.abs(windows)
    middle = 1.4826 * (np.nanmedian if np.isnan(deviation).any() else np.median)(deviation, axis=1)
    return np.where(middle > 0.0, middle, 1.2533 * np.nanmean(deviation, axis=1))


def _detrended(piece: FloatArray, calm: FloatArray) -> FloatArray:
    """The piece less the parabola of its calm version, with the variance that takes from white noise given back."""
    readings = np.count_nonzero(np.isfinite(piece))
    return np.asarray((piece - _through(calm)) * np.sqrt(readings / (readings - 3.0)))


def _through(values: FloatArray) -> FloatArray:
    """The parabola of least squares through the values that are not missing, at all rows."""
    basis = parabola(values.size)
    seen = np.isfinite(values)
    if seen.all():
        return np.asarray(basis @ (basis.T @ values))
    return np.asarray(basis @ np.linalg.lstsq(basis[seen], values[seen], rcond=None)[0])


def _without_outliers(signal: FloatArray, bound: float) -> FloatArray:
    """The signal with what is further than `bound` from the median of five readings set to that median."""
    calm = signal.copy()
    seen = np.isfinite(signal)
    readings = signal[seen]
    middle = median_filter(readings, 5, mode="nearest") if readings.size else readings
    calm[seen] = np.where(np.abs(readings - middle) > bound, middle, readings)
    return calm


def _joined(starts: IntArray, width: int, longest: int) -> list[tuple[int, int]]:
    """Half-open row ranges of windows that touch, none of more than `longest` windows."""
    if starts.size == 0:
        return []
    cuts = np.flatnonzero(np.diff(starts) != width) + 1
    ranges: list[tuple[int, int]] = []
    for run in np.split(starts, cuts):
        ranges += [(int(run[i]), int(run[min(i + longest, run.size) - 1]) + width) for i in range(0, run.size, longest)]
    return ranges
