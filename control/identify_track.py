"""One stretch of a record, ready for the valve's fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from control.identify_model import Grid, lagged_fine, make_grid
from control.identify_readings import fast_noise
from control.identify_starts import Reach
from logs.recording import FloatArray

ROUGH_S = 0.2  # sampling that is good enough for a first guess
FEWEST_KEPT = 30  # rows, however close together they are


@dataclass(frozen=True, slots=True)
class Track:
    """One record ready to be fitted: its grid, the driving pressure on it, and the position readings, shape (n,).

    `command`: what is commanded, on the grid, where no pressure was measured; `pressure` is then a guess of the lag.
    `later`: what drives the play, on the grid, if the converter's lag is longer by `lag_doubt_s`, half of the 95 %
    interval in which it may lie.
    """

    grid: Grid
    pressure: FloatArray
    position: FloatArray
    good: np.ndarray
    start: float  # the position at the first row
    doubts: tuple[FloatArray, ...] = ()  # what the pressure may be off by, on the grid
    command: FloatArray | None = None
    later: FloatArray | None = None
    lag_doubt_s: float = 0.0

    def driven(self, ep_tau_s: float | None) -> FloatArray:
        """The pressure on the grid if the converter's lag is that; as it was given for None."""
        if ep_tau_s is None or self.command is None:
            return self.pressure
        return lagged_fine(self.grid, self.command, ep_tau_s, float(self.pressure[0]))

    def lag_moved(self, way: float) -> Track:
        """The track with a lag longer (`way` = 1) or shorter (-1) by its doubt."""
        if self.later is None:
            return self
        return replace(self, pressure=self.pressure + way * (self.later - self.pressure))


def first_position(time_s: FloatArray, position: FloatArray, good: np.ndarray) -> float:
    """The position at the first row: a line through the good readings of the first second, or the first five."""
    when, values = time_s[good], position[good]
    count = min(when.size, max(5, int(np.searchsorted(when, when[0] + 1.0))))
    slope, start = np.polyfit(when[:count] - time_s[0], values[:count], 1)
    steady = abs(slope) * (when[count - 1] - time_s[0]) < 6.0 * fast_noise(values)
    return float(np.mean(values[:count]) if steady else start)


def thinned(track: Track, least_period_s: float = ROUGH_S) -> Track:
    """The same record with rows and sub-steps as coarse as a first guess allows.

    Positions may be missing with a period of their own: of the rows that could be kept those are that have the most.
    """
    time_s, fine_s = track.grid.time_s, track.grid.fine_time_s
    stride = max(1, int(least_period_s / max(float(np.median(np.diff(time_s))), 1e-6)))
    stride = min(stride, max(1, time_s.size // FEWEST_KEPT))
    keep = max((slice(first, None, stride) for first in range(stride)), key=lambda rows: int(track.good[rows].sum()))
    grid = make_grid(time_s[keep], 0.25 * least_period_s)
    pressure = np.interp(grid.fine_time_s, fine_s, track.pressure)
    later = None if track.later is None else np.interp(grid.fine_time_s, fine_s, track.later)
    command = track.command
    if command is not None:  # what is in force until a fine time counts there
        command = command[np.minimum(np.searchsorted(fine_s, grid.fine_time_s - 1e-9), fine_s.size - 1)]
    kept = Track(grid, pressure, track.position[keep], track.good[keep], track.start, command=command)
    return replace(kept, later=later, lag_doubt_s=track.lag_doubt_s)


def reach_of(tracks: Sequence[Track]) -> Reach:
    """How far pressure and position go in all of the tracks together."""
    return Reach(
        min(float(t.pressure.min()) for t in tracks),
        max(float(t.pressure.max()) for t in tracks),
        min(float(np.percentile(t.position[t.good], 0.5)) for t in tracks),
        max(float(np.percentile(t.position[t.good], 99.5)) for t in tracks),
    )
