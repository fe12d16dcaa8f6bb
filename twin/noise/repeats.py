"""Finds where the same command sequence was run twice, between recordings and inside one, by aligning the commands.

What a valve does twice alike is no noise, however odd it looks: the difference of two repeats holds only what did not
repeat. Deterministic disturbances common to both cancel and must be judged elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray, Recording
from twin.noise.copies import copied

_MATCH = 0.97  # share of time in which the commands must agree
_LEAST_SHARE = 0.5  # of the rows that lie over each other
_LEAST_S = 10.0
_LEAST_ROWS = 100
_MAX_PAIRS = 40
_MOVES = 0.5  # share of rows in which the command changes, from which on it says more exactly when it was repeated
_PARTS = 20  # of a row, by which that is looked for


@dataclass(frozen=True, slots=True)
class RepeatPair:
    """Row i of `first` (from `rows.start`) was commanded like the time `first.time_s[i] + shift_s` of `second`."""

    first: Recording
    second: Recording
    rows: slice
    shift_s: float

    def difference(self, name: str) -> FloatArray | None:
        """Noise of one signal, `(first - second)` scaled to one reading's sigma; None where it was not measured.

        A straight drift between the repeats is taken out: it does not repeat, yet it is no noise.
        """
        ours: FloatArray | None = getattr(self.first, name)
        found = self._other(name)
        if ours is None or found is None:
            return None
        other, part = found
        raw = ours[self.rows] - other
        # a mean of two readings is quieter than one: the scale follows the interpolation weights
        scaled = raw / np.sqrt(1.0 + np.mean(part**2 + (1.0 - part) ** 2))
        return _settled(np.asarray(scaled - _straight_line(scaled)))

    @property
    def copied(self) -> bool:
        """Whether both are one recording of the position, given twice or overlapping: that shows no noise."""
        found = self._other("position")
        return found is not None and copied(self.first.position[self.rows], found[0])

    def _other(self, name: str) -> tuple[FloatArray, FloatArray] | None:
        """The second recording's signal at the rows of the first, and where between its own rows that is (0 to 1)."""
        theirs: FloatArray | None = getattr(self.second, name)
        if theirs is None:
            return None
        at = self.first.time_s[self.rows] + self.shift_s
        right = np.clip(np.searchsorted(self.second.time_s, at), 1, self.second.n - 1)
        span = self.second.time_s[right] - self.second.time_s[right - 1]
        part = np.clip((at - self.second.time_s[right - 1]) / np.maximum(span, 1e-12), 0.0, 1.0)
        later = np.where(part > 0.0, part * theirs[right], 0.0)  # a missing neighbour of no weight does not matter
        other = later + np.where(part < 1.0, (1.0 - part) * theirs[right - 1], 0.0)
        other[span > 3.0 * self.second.period_s] = np.nan  # no straight line across a hole in the record
        return other, part


def find_repeats(recordings: Sequence[Recording], most: int | None = _MAX_PAIRS) -> list[RepeatPair]:
    """Pairs of stretches with the same command: each recording with the next like it, and with itself one period on.

    The first `most` of them, which is plenty to measure a noise by; None for all.
    """
    pairs: list[RepeatPair] = []
    representatives: list[Recording] = []
    for recording in recordings:
        if recording.n < _LEAST_ROWS:
            continue
        for place, earlier in enumerate(representatives):
            pair = _aligned(earlier, recording)
            if pair is not None:
                pairs += [] if pair.copied else [pair]
                representatives[place] = recording  # compare neighbours in time: what drifts, drifts least there
                break
        else:
            representatives.append(recording)
            own = _periodic(recording)
            if own is not None and not own.copied:
                pairs.append(own)
    return pairs[:most]


def _aligned(first: Recording, second: Recording) -> RepeatPair | None:
    """The second recording laid over the first, if some shift makes the commands agree."""
    start = float(second.time_s[0] - first.time_s[0])
    period = max(first.period_s, second.period_s)
    lags = _best_lags(_grid(first, period), _grid(second, period))
    for shift in [start, *(start + lag * period for lag in _and_beside(lags))]:
        pair = _checked(first, second, shift)
        if pair is not None:
            return pair
    return None


def _periodic(recording: Recording) -> RepeatPair | None:
    """The recording laid over itself one period later, for the shortest period with which the command repeats."""
    grid = _grid(recording, recording.period_s)
    lags = sorted(lag for lag in _best_lags(grid, grid, count=12) if lag * recording.period_s >= _LEAST_S)
    for lag in _and_beside(lags):
        pair = _checked(recording, recording, lag * recording.period_s)
        if pair is not None:
            return pair
    return None


def _checked(first: Recording, second: Recording, shift_s: float) -> RepeatPair | None:
    """The pair at this shift if the overlap is long enough and the commands agree there, apart from edges of steps."""
    inside = (first.time_s + shift_s >= second.time_s[0]) & (first.time_s + shift_s <= second.time_s[-1])
    rows = np.flatnonzero(inside)
    least = max(_LEAST_ROWS, round(_LEAST_S / first.period_s))
    if rows.size < max(least, 0.3 * min(first.n, second.n)) and not (first is second and rows.size >= least):
        return None
    span = slice(int(rows[0]), int(rows[-1]) + 1)
    at = np.clip(np.searchsorted(second.time_s, first.time_s[span] + shift_s - 1e-9), 0, second.n - 1)
    here, there = first.command[span], second.command[at]
    before, after = second.command[np.maximum(at - 1, 0)], second.command[np.minimum(at + 1, second.n - 1)]
    # one row of slack: two runs rarely sample the edge of a step alike
    low, high = np.minimum(np.minimum(before, after), there), np.maximum(np.maximum(before, after), there)
    slack = 2e-3 * max(float(np.ptp(here)), 1e-9)
    begin, end = _longest((here >= low - slack) & (here <= high + slack))
    if end - begin < max(least, _LEAST_SHARE * rows.size):
        return None
    return _between_rows(RepeatPair(first, second, slice(span.start + begin, span.start + end), shift_s))


def _between_rows(pair: RepeatPair) -> RepeatPair:
    """The pair with its shift to a fraction of a row, where the command tells: a sine's period is no whole number of
    rows, and what moves by a part of a row differs by more than its noise.
    """
    here = pair.first.command[pair.rows]
    if np.count_nonzero(np.diff(here)) < _MOVES * here.size:
        return pair
    at, row_s = pair.first.time_s[pair.rows] + pair.shift_s, pair.second.period_s
    parts = row_s * np.arange(-_PARTS, _PARTS + 1) / _PARTS
    misses = [
        float(np.mean((np.interp(at + part, pair.second.time_s, pair.second.command) - here)[1:-1] ** 2))
        for part in parts
    ]
    best = int(np.argmin(misses))
    return replace(pair, shift_s=pair.shift_s + float(parts[best])) if misses[best] < 0.5 * misses[_PARTS] else pair


def _longest(agree: npt.NDArray[np.bool_]) -> tuple[int, int]:
    """The stretch with most agreeing rows of which `_MATCH` agree: what comes before or after is no repeat.

    A conditioning stroke before the first of two sweeps is not repeated. Kadane's maximum subarray.
    """
    sums = np.concatenate([[0.0], np.cumsum(np.where(agree, 1.0 - _MATCH, -_MATCH))])
    end = int(np.argmax(sums - np.minimum.accumulate(sums)))
    return int(np.argmin(sums[: end + 1])), end


def _grid(recording: Recording, period_s: float) -> FloatArray:
    """The command's changes on an even grid."""
    at = np.arange(recording.time_s[0], recording.time_s[-1], period_s)
    rows = np.clip(np.searchsorted(recording.time_s, at - 1e-9), 0, recording.n - 1)
    return np.diff(recording.command[rows])


def _best_lags(first: FloatArray, second: FloatArray, count: int = 3) -> list[int]:
    """Lags (second later) at the highest peaks of the cross-correlation of two change sequences."""
    size = 1 << int(np.ceil(np.log2(first.size + second.size)))
    product = np.conj(np.fft.rfft(first, size)) * np.fft.rfft(second, size)
    correlation = np.fft.irfft(product, size)
    peaks = np.flatnonzero((correlation >= np.roll(correlation, 1)) & (correlation > np.roll(correlation, -1)))
    best = peaks[np.argsort(correlation[peaks])[::-1][:count]]
    return [int(lag) if lag <= size // 2 else int(lag) - size for lag in best]


def _and_beside(lags: Sequence[int]) -> list[int]:
    """Each lag, then its neighbours: uneven sampling puts the peak of a correlation a row off."""
    return [lag + step for lag in lags for step in (0, -1, 1)]


def _settled(difference: FloatArray) -> FloatArray:
    """The difference with its loud beginning set to NaN: two repeats differ until the play has forgotten its past."""
    blocks = np.array_split(np.abs(difference), 50)
    loud = np.array([np.nanmedian(block) if np.isfinite(block).any() else np.nan for block in blocks])
    usual = float(np.nanmedian(loud)) if np.isfinite(loud).any() else 0.0
    settled = difference.copy()
    start = 0
    for block, level in zip(blocks, loud, strict=True):
        if level <= 2.0 * usual or start > difference.size // 2:
            break
        settled[start : start + block.size] = np.nan
        start += block.size
    return settled


def _straight_line(values: FloatArray) -> FloatArray:
    """A line through the medians of twenty blocks: outliers and steps do not tilt it."""
    blocks = np.array_split(values, 20)
    medians = np.array([np.nanmedian(block) if np.isfinite(block).any() else np.nan for block in blocks])
    known = np.flatnonzero(np.isfinite(medians))
    if known.size < 2:
        return np.zeros_like(values)
    slopes = (medians[known][:, None] - medians[known]) / np.where(np.eye(known.size), np.nan, known[:, None] - known)
    slope = float(np.nanmedian(slopes))
    level = float(np.median(medians[known] - slope * known))
    rows = (np.arange(values.size) + 0.5) * 20.0 / values.size - 0.5
    return level + slope * rows
