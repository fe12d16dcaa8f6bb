"""Random levels held for random times: reversals everywhere, every number of the model excited at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from control.experiment import Experiment, level, number, seconds
from control.step import Step


@dataclass(frozen=True, kw_only=True)
class RandomSteps(Experiment):
    """`count` levels, uniform between `low` and `high`, each held for a time uniform between the two dwells."""

    kind: ClassVar[str] = "random"
    low: float = level(4.0, "lowest level")
    high: float = level(13.0, "highest level")
    count: int = number(60, "number of levels", least=1, most=100_000)
    dwell_min_s: float = seconds(2.0, "shortest stay", least=0.05)
    dwell_max_s: float = seconds(20.0, "longest stay", least=0.05)

    def check(self) -> None:
        if self.low >= self.high:
            raise self.wrong("low", self.low, f"must lie below high = {self.high:g}")
        if self.dwell_min_s > self.dwell_max_s:
            raise self.wrong("dwell_min_s", self.dwell_min_s, f"is above dwell_max_s = {self.dwell_max_s:g}")

    def one_pass(self) -> tuple[Step, ...]:
        chance = np.random.default_rng(int(self.seed))
        levels = chance.uniform(self.low, self.high, int(self.count)).tolist()
        dwells_s = chance.uniform(self.dwell_min_s, self.dwell_max_s, int(self.count)).tolist()
        steps, before = [], self.low
        for end, dwell_s in zip(levels, dwells_s, strict=True):
            steps.append(Step(before, end, 0.0, dwell_s, until_settled=self.until_settled))
            before = end
        return tuple(steps)


EXPERIMENT = RandomSteps
