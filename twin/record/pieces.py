"""A record cut where samples are missing for so long that nobody knows what the valve did meanwhile."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import DataNote, FloatArray, Recording
from twin.record.stored_on_change import held_through_holes

#: A hole is bridged when it is shorter than this, in periods and in seconds ...
_PERIODS = 5.0
_LEAST_S = 1.0
#: ... or when the command is the same on both sides (to this share of its span) and it is no longer than this [s].
_SAME = 0.005
_HELD_S = 10.0
#: Pieces shorter than this say too little; no record is cut into more pieces than this.
LEAST_PIECE_S = 20.0
LEAST_PIECE_ROWS = 40
MOST_PIECES = 40
#: Up to so many rows after a hole that repeat the reading before it are a converter that had nothing newer.
_REPEATED = 12


def cut_at_holes(recordings: Sequence[Recording]) -> tuple[list[Recording], list[DataNote]]:
    """The recordings, each cut at its holes into recordings of their own; notes say where and what was left out.

    A model that runs through a hole would be told a command that nobody recorded, and be wrong long after it. One that
    was stored on change is not cut: its command is known.
    """
    pieces: list[Recording] = []
    notes: list[DataNote] = []
    for given in recordings:
        recording, held = held_through_holes(given)
        if held:
            pieces.append(recording)
            notes += held
            continue
        own, lost, old = _cut(recording)
        if len(own) == 1 and not lost + old:
            pieces.append(recording)
            continue
        pieces += own
        what = f"{recording.name}: holes in the record with unknown commands in them"
        left = f"; {lost} rows between holes are too few and are left out" if lost else ""
        left += f"; {old} rows after holes, which repeat the reading before, are left out" if old else ""
        notes.append(DataNote(what, f"cut into {len(own)} pieces, each with a start of its own{left}", lost + old))
    return pieces, notes


def _cut(recording: Recording) -> tuple[list[Recording], int, int]:
    """The pieces that are long enough; how many rows are in the others, and how many say what was before a hole."""
    holes = _holes(recording)
    if holes.size == 0:
        return [recording], 0, 0
    edges = [0, *holes.tolist(), recording.n]
    first = [0, *(a + _repeats(recording.position, a) for a in holes.tolist())]
    parts = [recording.slice(a, b) for a, b in zip(first, edges[1:], strict=True)]
    kept = [p for p in parts if p.n >= LEAST_PIECE_ROWS and p.duration_s >= LEAST_PIECE_S]
    if not kept:
        return [recording], 0, 0
    named = [replace(p, name=f"{recording.name}[{k}]", notes=()) for k, p in enumerate(kept, start=1)]
    if len(named) == 1:
        named = [replace(named[0], name=recording.name)]
    named[0] = replace(named[0], notes=recording.notes)
    old = sum(a - b for a, b in zip(first, edges[:-1], strict=True))
    return named, recording.n - sum(p.n for p in kept) - old, old


def _repeats(position: FloatArray, row: int) -> int:
    """How many readings from `row` on are the one before it: where the stem was, and by now is not.

    None where there are so many that it may have rested.
    """
    new = np.flatnonzero(position[row : row + _REPEATED + 1] != position[row - 1])
    return int(new[0]) if new.size else 0


def _holes(recording: Recording) -> np.ndarray:
    """The rows that begin a new piece."""
    if recording.n < 2:
        return np.zeros(0, dtype=np.int64)
    steps = np.diff(recording.time_s)
    long = steps > max(_PERIODS * recording.period_s, _LEAST_S)
    changed = np.abs(np.diff(recording.command)) > _SAME * max(float(np.ptp(recording.command)), 1e-12)
    at = np.flatnonzero(long & (changed | (steps > _HELD_S)))
    if at.size >= MOST_PIECES:
        at = np.sort(at[np.argsort(steps[at])[::-1][: MOST_PIECES - 1]])
    return at + 1
