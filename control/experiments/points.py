"""Any sequence of levels, each with its own rise and stay: what no other kind can say."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from control.experiment import Experiment
from control.step import Step


@dataclass(frozen=True, kw_only=True)
class Points(Experiment):
    """`points` is a list of [level, rise_s, hold_s]; the first rises from the low end of the conditioning stroke."""

    kind: ClassVar[str] = "points"
    points: tuple[tuple[float, float, float], ...] = ((10.0, 0.0, 30.0), (4.0, 0.0, 30.0))

    def __post_init__(self) -> None:
        rows = []
        if not isinstance(self.points, list | tuple) or not self.points:
            raise self.wrong("points", self.points, "must be a list of [level, rise_s, hold_s]")
        for number, row in enumerate(self.points, start=1):
            numeric = isinstance(row, list | tuple) and all(
                isinstance(item, int | float) and not isinstance(item, bool) and math.isfinite(item) for item in row
            )
            if not numeric or len(row) != 3:
                raise self.wrong(f"points, row {number}", row, "must be [level, rise_s, hold_s]")
            if row[1] < 0.0 or row[2] < 0.0 or row[1] + row[2] <= 0.0:
                raise self.wrong(f"points, row {number}", row, "needs times that are not negative and not both 0")
            rows.append((float(row[0]), float(row[1]), float(row[2])))
        object.__setattr__(self, "points", tuple(rows))
        super().__post_init__()

    def one_pass(self) -> tuple[Step, ...]:
        steps, before = [], self.conditioning_low
        for end, rise_s, hold_s in self.points:
            steps.append(Step(before, end, rise_s, hold_s, until_settled=self.until_settled))
            before = end
        return tuple(steps)


EXPERIMENT = Points
