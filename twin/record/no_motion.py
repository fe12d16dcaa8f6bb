"""Whether readings that are far from their neighbours can have been the stem."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from control.design import DesignModel
from logs.recording import Recording
from twin.noise.model import NoiseModel

#: The typical false reading is so many times as far off as a stem at full speed gets between two readings.
_BEYOND = 1.5
#: So many of them cannot have been the stem: each came while it stood, six around it lying within so many sigmas,
_SINGLE, _STILL_SIGMAS = 5, 5.0
#: ... or while the commands went by less than this share of the deadband, in so many lags before it and until the next.
_CROSSED, _LAGS = 0.5, 5.0


def no_motion(
    recordings: Sequence[Recording], false: Sequence[np.ndarray], noise: NoiseModel, design: DesignModel
) -> bool:
    """Whether the `false` readings (rows of each recording) are none of a moving stem's.

    It was not as fast, or it stood, or it did not turn: to go and to come back the pressure has to cross the deadband.
    """
    pairs = list(zip(recordings, false, strict=True))
    periods = zip(jumps_of(recordings, false), recordings, strict=True)
    steps = np.concatenate([jumps / (design.rate_limit * recording.period_s) for jumps, recording in periods])
    if steps.size and np.median(steps) > _BEYOND:
        return True
    return (
        sum(int(np.sum(rows & (_still(r, rows, noise) | _not_turned(r, rows, design)))) for r, rows in pairs) >= _SINGLE
    )


def jumps_of(recordings: Sequence[Recording], false: Sequence[np.ndarray]) -> list[np.ndarray]:
    """How far each false reading lies from the line between its good neighbours, per recording [position]."""
    jumps = []
    for recording, rows in zip(recordings, false, strict=True):
        known = np.isfinite(recording.position)
        good, bad = np.flatnonzero(~rows & known), np.flatnonzero(rows & known)
        between = np.interp(bad, good, recording.position[good]) if good.size else recording.position[bad]
        jumps.append(np.abs(recording.position[bad] - between))
    return jumps


def _still(recording: Recording, rows: np.ndarray, noise: NoiseModel) -> np.ndarray:
    """Rows around which the stem stood, no other false one among them: no lag lets it go and come back between two."""
    beside, at = (0, 1, 2, 4, 5, 6), np.zeros(recording.n, dtype=bool)
    if recording.n < 7:
        return at
    around = np.lib.stride_tricks.sliding_window_view(recording.position, 7)[:, beside]
    alone = ~np.lib.stride_tricks.sliding_window_view(rows, 7)[:, beside].any(axis=1)
    at[3:-3] = (np.ptp(around, axis=1) < _STILL_SIGMAS * noise.position.sigma) & alone  # NaN compares false
    return at


def _not_turned(recording: Recording, rows: np.ndarray, design: DesignModel) -> np.ndarray:
    """False readings around which the commands stayed within a part of the deadband."""
    at, time_s = np.zeros(recording.n, dtype=bool), recording.time_s
    reach_s = _LAGS * (design.ep_tau_s + design.tau_s)
    for row in np.flatnonzero(rows):
        first = int(np.searchsorted(time_s, time_s[row] - reach_s))
        if 0 < row < recording.n - 1:
            at[row] = np.ptp(recording.command[first : row + 2]) < _CROSSED * design.deadband
    return at
