"""Readings that are in the records twice: a file named twice, or a run and its own export.

Two repeats of a command differ by the noise of both; a copy differs by the digits it was written with, and would make
the noise seem to be nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import DataNote, FloatArray, Recording

#: Of the usual change from row to row: what a copy may be off, by rounding. Of two readings of their own with noise in
#: them, one in sixty comes as near by chance.
_ROUNDING = 0.03
#: Of the rows in which the reading changes: as many have to be the same.
_SAME = 0.95
#: Of the sampling period: what the times of a copy may be off.
_TIME = 0.05


def copied(first: FloatArray, second: FloatArray) -> bool:
    """Whether two readings of the same rows, shape (n,), are one and the same; False where nothing ever changes."""
    step = np.abs(np.diff(first, prepend=first[:1]))
    moving = (step > 0.0) & np.isfinite(first) & np.isfinite(second)
    if not moving.any():
        return False
    off = np.abs(first - second)[moving]
    return bool(np.mean(off <= _ROUNDING * np.median(step[moving])) >= _SAME)


def used_once(recordings: Sequence[Recording]) -> tuple[list[Recording], list[DataNote]]:
    """The recordings without copies of each other, and a note on every copy; of two the richer stays."""
    kept: list[Recording] = []
    notes: list[DataNote] = []
    for one in recordings:
        place = next((k for k, other in enumerate(kept) if _same_record(other, one)), None)
        if place is None:
            kept.append(one)
            continue
        other = kept[place]
        what = f"{one.name} holds the same readings as {other.name}"
        notes.append(DataNote(what, "used once: a copy says nothing new, least of all about noise", one.n))
        if _signals(one) > _signals(other):
            kept[place] = replace(one, notes=(*other.notes, *one.notes))
    return kept, notes


def _same_record(first: Recording, second: Recording) -> bool:
    if first.n != second.n or first.n < 2:
        return False
    times = first.time_s - first.time_s[0] - (second.time_s - second.time_s[0])
    return bool(np.max(np.abs(times)) <= _TIME * first.period_s) and copied(first.position, second.position)


def _signals(recording: Recording) -> int:
    """How many of pressure, target and the run's own story a recording has."""
    return sum((recording.pressure is not None, recording.target is not None, bool(recording.meta)))
