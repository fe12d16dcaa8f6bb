"""A time column made fit for use: one time per row, ascending; what cannot be repaired is refused with its row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hal.counted import counted
from hal.errors import BadInput
from logs.recording import DataNote, FloatArray

COARSE_SHARE = 0.2  # above this share of repeated times the clock is taken to be coarse, below it rows to be doubled
GAP_PERIODS = 1.75  # an interval longer than this many median periods has samples missing in it
_WRAPS = (2.0**16, 2.0**32, 86_400.0, 3_600.0)


@dataclass(frozen=True, slots=True)
class Times:
    """`time_s` for the rows `keep` (indices into the file's rows), and what was found on the way."""

    time_s: FloatArray
    keep: np.ndarray[tuple[int], np.dtype[np.intp]]
    notes: tuple[DataNote, ...]
    doubled: bool = False


def unwrap(raw: FloatArray, unit_s: float) -> tuple[FloatArray, list[DataNote]]:
    """Undoes a counter that ran over (16 or 32 bits of the file's unit) or a time of day that passed midnight.

    Only a fall from within 5 periods of the end to within 5 periods of zero counts as one.
    """
    steps = np.diff(raw)
    falls = np.flatnonzero(steps < 0)
    if falls.size == 0 or raw.size < 3 or float(np.nanmedian(steps)) < 0.0:  # a clock that mostly falls is no counter
        return raw, []
    near = 5.0 * float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    for modulus in (*_WRAPS[:2], _WRAPS[2] / unit_s, _WRAPS[3] / unit_s):
        if np.all(raw[falls] > modulus - near) and np.all(raw[falls] <= modulus) and np.all(raw[falls + 1] < near):
            lifted = raw.copy()
            for fall in falls:
                lifted[fall + 1 :] += modulus
            first = int(falls[0]) + 2
            note = DataNote(f"the time counter ran over at {modulus:g}", "unwrapped", int(falls.size), first)
            return lifted, [note]
    return raw, []


def ascending(time_s: FloatArray, where: str, locate: Callable[[int], str]) -> Times:
    """Drops rows without a time, turns round a file that is newest first, sorts out repeated times.

    Times that go backward now and then are refused: which of the rows are right is not known.

    Raises: `BadInput` naming the row and both times, or when fewer than two rows have a time.
    """
    notes: list[DataNote] = []
    bad = ~np.isfinite(time_s)
    keep = np.flatnonzero(~bad)
    if bad.any():
        first = int(np.flatnonzero(bad)[0]) + 1
        notes.append(DataNote("rows without a usable time", "left out; the gap is marked", int(bad.sum()), first))
    if keep.size < 2:
        raise BadInput(f"{where}: {counted(keep.size, 'row')} with a usable time; a recording needs at least 2")
    time_s = time_s[keep]
    steps = np.diff(time_s)
    if steps.size > 1 and np.all(steps <= 0) and np.any(steps < 0):
        notes.append(DataNote("rows stand newest first", "put in the order of time", int(keep.size), 1))
        keep, time_s = keep[::-1], time_s[::-1]
        steps = np.diff(time_s)
    if np.any(steps < 0):
        at = int(np.flatnonzero(steps < 0)[0])
        raise BadInput(
            f"{where}: {locate(int(keep[at + 1]))}: the time goes backward, from {time_s[at]:.10g} s to "
            f"{time_s[at + 1]:.10g} s; sort the file, or split it where the clock was set"
        )
    repeated = steps == 0
    if not repeated.any():
        return Times(time_s, keep, tuple(notes))
    first, count = int(keep[int(np.flatnonzero(repeated)[0]) + 1]) + 1, int(repeated.sum())
    if count == steps.size:
        raise BadInput(f"{where}: every row has the same time, {time_s[0]:.10g} s; name the right column with --map")
    if count > COARSE_SHARE * steps.size:
        notes.append(DataNote("times repeat: the clock is coarser than the sampling", "spread evenly", count, first))
        return Times(_spread(time_s), keep, tuple(notes))
    notes.append(DataNote("rows with the time of the row before", "averaged into one row", count, first))
    return Times(time_s, keep, tuple(notes), doubled=True)


def _spread(time_s: FloatArray) -> FloatArray:
    """Rows that share a time, spread evenly up to the next time; the last group as wide as the median one."""
    starts = np.flatnonzero(np.concatenate(([True], np.diff(time_s) > 0)))
    sizes = np.diff(np.append(starts, time_s.size))
    widths = np.diff(time_s[starts])
    widths = np.append(widths, float(np.median(widths)))
    inside = np.arange(time_s.size) - np.repeat(starts, sizes)
    return np.asarray(time_s + inside * np.repeat(widths / sizes, sizes), dtype=np.float64)


def merge_doubles(time_s: FloatArray, values: FloatArray, average: bool) -> FloatArray:
    """One value per distinct time: the mean of those that are not NaN, or the first."""
    starts = np.flatnonzero(np.concatenate(([True], np.diff(time_s) > 0)))
    if not average:
        return values[starts]
    good = np.isfinite(values)
    total = np.add.reduceat(np.where(good, values, 0.0), starts)
    count = np.add.reduceat(good.astype(np.float64), starts)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1.0), np.nan), dtype=np.float64)


def gaps(time_s: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """True where samples are missing between a row and the one before it."""
    marks = np.zeros(time_s.size, dtype=np.bool_)
    if time_s.size > 2:
        steps = np.diff(time_s)
        marks[1:] = steps > GAP_PERIODS * float(np.median(steps))
    return marks


def timing_notes(time_s: FloatArray, gap_before: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> list[DataNote]:
    """What the spacing of the rows looks like, where it is worth a word."""
    notes: list[DataNote] = []
    if time_s.size < 3:
        return notes
    steps = np.diff(time_s)
    period_s = float(np.median(steps))
    if gap_before.any():
        longest = float(steps[gap_before[1:]].max())
        first = int(np.flatnonzero(gap_before)[0]) + 1
        notes.append(
            DataNote(f"gaps in time, the longest {longest:.4g} s", "marked; not bridged", int(gap_before.sum()), first)
        )
    even = steps[~gap_before[1:]]
    jitter = float(np.std(even) / period_s) if even.size else 0.0
    if jitter > 0.05:
        text = f"uneven sampling: {100 * jitter:.0f} % of the {period_s:.4g} s period (standard deviation)"
        notes.append(DataNote(text, "each row used at its own time", int(even.size)))
    return notes
