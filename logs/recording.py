"""A recording as arrays: what analysis, identification and diagnosis read, wherever the samples came from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
CommandTiming = Literal["before", "after", "unknown"]


@dataclass(frozen=True, slots=True)
class DataNote:
    """One finding of the data-quality check: `what` happened, how it was `handled`, in how many `rows`, from where.

    `first_row` is the first of them in the file, counted from 1 below the header.
    """

    what: str
    handled: str
    rows: int = 0
    first_row: int | None = None


@dataclass(frozen=True, slots=True)
class Recording:
    """Samples in time order; every array is float64 of shape (n,).

    `command[i]` is the command in force over the interval that ends at `time_s[i]` (timing "before"). Loading turns
    a file with timing "after" into one with "before", so that only "before" and "unknown" have to be dealt with.
    `pressure` is None where it was not measured; NaN marks a missing sample; `target` is None in open loop.
    `gap_before[i]` is True where samples are missing between i-1 and i, so that the state there is uncertain.
    """

    name: str
    time_s: FloatArray
    command: FloatArray
    position: FloatArray
    pressure: FloatArray | None = None
    target: FloatArray | None = None
    pressure_unit: str = "psi"
    position_unit: str = "in"
    command_timing: CommandTiming = "before"
    gap_before: npt.NDArray[np.bool_] | None = None
    notes: tuple[DataNote, ...] = ()
    meta: Mapping[str, object] = field(default_factory=dict)

    @property
    def n(self) -> int:
        return int(self.time_s.size)

    @property
    def period_s(self) -> float:
        """The median sampling period [s]."""
        return float(np.median(np.diff(self.time_s))) if self.n > 1 else float("nan")

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1] - self.time_s[0]) if self.n else 0.0

    def slice(self, start: int, stop: int) -> Recording:
        """Rows start..stop-1 as a recording of its own."""

        def cut(array: FloatArray | None) -> FloatArray | None:
            return None if array is None else array[start:stop]

        return replace(
            self,
            time_s=self.time_s[start:stop],
            command=self.command[start:stop],
            position=self.position[start:stop],
            pressure=cut(self.pressure),
            target=cut(self.target),
            gap_before=None if self.gap_before is None else self.gap_before[start:stop],
        )
