"""The fine time grid: every sampling interval cut into equal steps short enough for the lags in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray


@dataclass(frozen=True, slots=True)
class TimeGrid:
    """`offsets[i]` is the fine index of row i (int64, shape (n,)); the fine grid has offsets[-1] + 1 points."""

    time_s: FloatArray
    offsets: npt.NDArray[np.int64]

    @property
    def n_fine(self) -> int:
        return int(self.offsets[-1]) + 1

    @property
    def fine_time_s(self) -> FloatArray:
        """Times of the fine points [s], shape (n_fine,)."""
        return np.interp(np.arange(self.n_fine), self.offsets, self.time_s)


def make_grid(time_s: FloatArray, step_s: float) -> TimeGrid:
    """Cuts each interval into the fewest equal steps no longer than `step_s` [s]; a gap gets at most 10,000 steps."""
    steps = np.clip(np.ceil(np.diff(time_s) / step_s - 1e-9), 1, 10_000).astype(np.int64)
    return TimeGrid(np.ascontiguousarray(time_s, dtype=np.float64), np.concatenate([[0], np.cumsum(steps)]))
