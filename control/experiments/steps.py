"""Single large steps, to several heights and back: step responses, rate limit and time constants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from control.experiment import Experiment, level, number, seconds
from control.step import Step, joined


@dataclass(frozen=True, kw_only=True)
class Steps(Experiment):
    """`low` -> level -> `low` for `heights` levels spread evenly up to `high`, the smallest first.

    The levels begin a `heights`-th of the range above `low`; those below the closing curve show the deadband.
    """

    kind: ClassVar[str] = "steps"
    low: float = level(4.0, "level between the steps")
    high: float = level(13.0, "highest level")
    heights: int = number(8, "number of different heights", least=1, most=1000)
    dwell_s: float = seconds(25.0, "stay on each level; the longest stay with until_settled", least=0.1)

    def check(self) -> None:
        if self.low == self.high:
            raise self.wrong("high", self.high, "is low as well: there is no step between equal levels")

    def one_pass(self) -> tuple[Step, ...]:
        levels: list[float] = []
        for i in range(1, int(self.heights) + 1):
            levels += [self.low + (self.high - self.low) * i / self.heights, self.low]
        return tuple(joined(tuple(levels), self.low, rise_s=0.0, hold_s=self.dwell_s, until_settled=self.until_settled))


EXPERIMENT = Steps
