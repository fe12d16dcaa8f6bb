"""Slow ramps up and down over both curves: the quasi-static loop, with every stick and slip in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from control.experiment import Experiment, level, rate, seconds
from control.step import Step


@dataclass(frozen=True, kw_only=True)
class Ramp(Experiment):
    """From `low` to `high` at a constant rate, a stay, and back down."""

    kind: ClassVar[str] = "ramp"
    low: float = level(4.0, "lowest level")
    high: float = level(13.0, "highest level")
    rate_per_s: float = rate(0.05, "slope")
    dwell_s: float = seconds(20.0, "stay at each end")

    def check(self) -> None:
        if self.low >= self.high:
            raise self.wrong("low", self.low, f"must lie below high = {self.high:g}")

    def one_pass(self) -> tuple[Step, ...]:
        rise_s = (self.high - self.low) / self.rate_per_s
        return (
            Step(self.low, self.high, rise_s, self.dwell_s, until_settled=self.until_settled),
            Step(self.high, self.low, rise_s, self.dwell_s, until_settled=self.until_settled),
        )


EXPERIMENT = Ramp
