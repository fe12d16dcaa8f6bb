"""Equal steps up over the closing curve and down over the opening curve: the characterization sweep of the thesis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from control.experiment import Experiment, level, seconds, span
from control.step import Step, joined


def ladder(start: float, end: float, step: float) -> list[float]:
    """Levels after `start` in equal steps of `step` (the last may be shorter), `end` included."""
    count = max(1, int(np.ceil(abs(end - start) / step - 1e-9)))
    sign = 1.0 if end >= start else -1.0
    return [start + sign * step * i for i in range(1, count)] + [end]


@dataclass(frozen=True, kw_only=True)
class Staircase(Experiment):
    """From `low` in steps to `high` and back. Every dwell ends on one of the two curves, or inside the deadband."""

    kind: ClassVar[str] = "staircase"
    low: float = level(4.0, "lowest level")
    high: float = level(13.0, "highest level")
    step: float = span(0.25, "height of a step")
    rise_s: float = seconds(0.0, "time a step takes to rise; 0 jumps")
    dwell_s: float = seconds(15.0, "stay on each step; the longest stay with until_settled", least=0.1)

    def check(self) -> None:
        if self.low >= self.high:
            raise self.wrong("low", self.low, f"must lie below high = {self.high:g}")

    def one_pass(self) -> tuple[Step, ...]:
        levels = (*ladder(self.low, self.high, self.step), *ladder(self.high, self.low, self.step))
        return tuple(
            joined(levels, self.low, rise_s=self.rise_s, hold_s=self.dwell_s, until_settled=self.until_settled)
        )


EXPERIMENT = Staircase
