"""Which rows of a recording stay when it is thinned, and what they then carry."""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray, Recording

Rows = npt.NDArray[np.int64]

_JUMP = 0.005  # share of the command's span that is a jump


def kept_rows(command: FloatArray, most: int, besides: Rows | None = None) -> Rows:
    """At most `most` of the rows 0..n-1, evenly; besides them the last, and both sides of every jump of the command.

    `besides`: rows of which both sides are kept as well.
    """
    n = command.size
    if most >= n:
        return np.arange(n, dtype=np.int64)
    change = np.abs(np.diff(command))
    least = _JUMP * max(float(np.ptp(command)), 1e-12)
    jumps = np.flatnonzero(change > least)
    if jumps.size > most // 4:  # a command that moves all the time has no edges; its largest ones are kept
        jumps = np.sort(jumps[np.argsort(change[jumps], kind="stable")[::-1][: most // 4]])
    more = np.zeros(0, dtype=np.int64) if besides is None else besides
    edges = np.concatenate([[0, n - 1], jumps, jumps + 1, np.maximum(more - 1, 0), more])
    stride = ceil(n / most)
    return np.unique(np.concatenate([edges, np.arange(0, n, stride)])).astype(np.int64)


def thinned(recording: Recording, rows: Rows) -> Recording:
    """The recording at `rows` (ascending, the first is 0) with the mean command since the row before."""
    time_s = recording.time_s
    if rows.size == recording.n:
        return recording
    worked = np.concatenate([[0.0], np.cumsum(recording.command[1:] * np.diff(time_s))])
    command = recording.command[rows].copy()
    command[1:] = np.diff(worked[rows]) / np.diff(time_s[rows])
    gaps = None
    if recording.gap_before is not None:
        gaps = np.diff(np.concatenate([[0], np.cumsum(recording.gap_before)])[rows + 1], prepend=0) > 0

    def at(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else values[rows]

    return replace(
        recording,
        time_s=time_s[rows],
        command=command,
        position=recording.position[rows],
        pressure=at(recording.pressure),
        target=at(recording.target),
        gap_before=gaps,
    )
