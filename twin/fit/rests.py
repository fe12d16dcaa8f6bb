"""Rests of the stem, found in the reading alone: where a model may be told the position, so that each move is judged by
itself.

Whether a valve with stiction slips now or a minute later hangs on less than the noise. A model that runs free and
decides once otherwise stands elsewhere until the next large stroke, and the squares over the whole record then compare
accidents. Where the stem rests, play output and stem are the reading; from there on the model has to move by itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import uniform_filter1d

from logs.recording import FloatArray

#: Length of the stretch over which a rest is judged, and the fewest rows in it.
_WINDOW_S, _LEAST_ROWS = 2.0, 8
#: A stretch rests when it drifts by less than so many deviations of what noise makes of it, or this share of travel.
_DRIFT_SIGMAS, _DRIFT_SHARE = 2.0, 3e-4
#: ... and scatters no more about its line than this many times the noise.
_SCATTER = 1.5
#: A move is longer than so many deviations of the noise.
_MOVE_SIGMAS = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Rests:
    """First and last of each rest: `rows` (int64, rising) and the mean `reading` around each; shape (m,)."""

    rows: npt.NDArray[np.int64]
    reading: FloatArray


def find_rests(
    time_s: FloatArray, reading: FloatArray, use: npt.NDArray[np.bool_], sigma: float, memory: float, travel: float
) -> Rests:
    """Where the stem has come to rest after each move, and where it rests last before the next.

    `use` marks trustworthy readings, `sigma` is their noise, `memory` how many samples of it are worth one.
    """
    period = float(np.median(np.diff(time_s)))
    width = max(_LEAST_ROWS, round(_WINDOW_S / period)) | 1
    if reading.size < 2 * width:
        return Rests(np.zeros(0, dtype=np.int64), np.zeros(0))
    half = width // 2
    y = np.where(use, reading, np.interp(np.arange(reading.size), np.flatnonzero(use), reading[use]))
    mean, slope, scatter = _lines(y, width)
    noise = sigma * np.sqrt(min(memory, width / 3.0))
    drift = np.abs(slope) * width
    still = drift <= max(_DRIFT_SIGMAS * noise * np.sqrt(12.0 / width), _DRIFT_SHARE * travel)
    still &= scatter <= _SCATTER * max(sigma, 1e-6 * travel)
    still &= uniform_filter1d(use.astype(np.float64), width) > 0.9
    still &= _even(time_s, width, period)
    still[: half + 1] = still[-half - 1 :] = False
    first = still & ~np.concatenate([[False], still[:-1]])
    last = still & ~np.append(still[1:], False)
    rows = np.flatnonzero(first | last)
    kept = _first_and_last(mean[rows], _MOVE_SIGMAS * sigma, sigma)
    return Rests(rows[kept].astype(np.int64), mean[rows[kept]])


def _first_and_last(level: FloatArray, move: float, same: float) -> list[int]:
    """Of each group of neighbouring `level`s no further apart than `move` the last, and the first that is the `same`.

    Within a group there was noise only, or the end of a settling, which is no rest yet.
    """
    kept: list[int] = []
    stop = level.size
    while stop > 0:
        last = stop - 1
        while stop > 0 and abs(level[stop - 1] - level[last]) <= move:
            stop -= 1
        near = stop + np.flatnonzero(np.abs(level[stop : last + 1] - level[last]) <= same)
        kept += [last] if near[0] == last else [last, int(near[0])]
    return kept[::-1]


def _lines(y: FloatArray, width: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean, slope per row and residual deviation of a line over the `width` rows around each row."""
    rows = np.arange(y.size, dtype=np.float64)
    base = float(np.mean(y))
    mean = uniform_filter1d(y - base, width)
    cross = uniform_filter1d((y - base) * (rows - rows.mean()), width) - mean * (rows - rows.mean())
    spread = (width**2 - 1.0) / 12.0
    slope = cross / spread
    variance = uniform_filter1d((y - base) ** 2, width) - mean**2 - slope**2 * spread
    return mean + base, slope, np.sqrt(np.maximum(variance, 0.0))


def _even(time_s: FloatArray, width: int, period_s: float) -> npt.NDArray[np.bool_]:
    """Whether the `width` rows around each row have no gap in them."""
    gap = np.append(np.diff(time_s) > 3.0 * period_s, False).astype(np.float64)
    return np.asarray(uniform_filter1d(gap, width) < 0.5 / width)
