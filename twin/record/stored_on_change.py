"""Records that a historian stored on change: while nothing was stored, nothing had changed.

Such a record has holes wherever the loop was calm. Ordinarily nobody knows what was commanded in a hole, and a record
is cut there (`twin/record/pieces.py`). But where neither command nor reading moves by more across a hole than from row
to row, and that in practically all of many holes, nothing was stored because nothing had changed: the command
before a hole went on holding until the row behind it was stored.
Source: OSIsoft, PI Server: exception reporting and compression testing (concept; the last value before a change may be
stored besides, with its own time).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from logs.recording import DataNote, FloatArray, Recording

#: Holes are longer than so many periods. So many at least, all but this share of them calm, make a record such a one.
_PERIODS, _LEAST, _OTHERS = 2.5, 8, 0.02
#: Moves from row to row are so large at the most, but for this share of them; what is more than twice that is no calm.
_LARGE, _CALM = 0.02, 2.0


def held_through_holes(recording: Recording) -> tuple[Recording, list[DataNote]]:
    """The recording with a row before the end of each hole that repeats the command before it; the reading is unknown.

    As it is where holes are few, or something happened in them.
    """
    holes = np.flatnonzero(np.diff(recording.time_s) > _PERIODS * recording.period_s)
    if holes.size < _LEAST or not _calm(recording, holes):
        return recording, []
    at = holes + 1
    time_s = np.insert(recording.time_s, at, recording.time_s[at] - 0.5 * recording.period_s)
    filled = replace(
        recording,
        time_s=time_s,
        command=np.insert(recording.command, at, recording.command[holes]),
        position=np.insert(recording.position, at, np.nan),
        pressure=_with_unknown(recording.pressure, at),
        target=None if recording.target is None else np.insert(recording.target, at, recording.target[holes]),
        gap_before=None,
    )
    what = f"{recording.name}: {holes.size} holes in which nothing had changed, as a historian stores on change"
    return filled, [DataNote(what, "the command before each is taken to hold until its end", int(holes.size))]


def _calm(recording: Recording, holes: np.ndarray) -> bool:
    """Whether neither command nor reading moves by more across the holes than from row to row."""
    for signal in (recording.command, recording.position):
        moves = np.abs(np.diff(signal))
        others = np.delete(moves, holes)
        others = others[np.isfinite(others)]
        if not others.any():
            return False
        across = moves[holes][np.isfinite(moves[holes])]
        if np.count_nonzero(across > _CALM * np.quantile(others, 1.0 - _LARGE)) > _OTHERS * holes.size:
            return False
    return True


def _with_unknown(signal: FloatArray | None, at: np.ndarray) -> FloatArray | None:
    return None if signal is None else np.insert(signal, at, np.nan)
