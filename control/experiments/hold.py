"""One command, held: noise floor, drift, leaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from control.experiment import Experiment, level, seconds
from control.step import Step


@dataclass(frozen=True, kw_only=True)
class Hold(Experiment):
    """`at` for `hold_s`, reached from the low end of the conditioning stroke, so on the closing curve."""

    kind: ClassVar[str] = "hold"
    at: float = level(10.0, "the command")
    hold_s: float = seconds(300.0, "how long", least=0.1)

    def one_pass(self) -> tuple[Step, ...]:
        return (Step(self.at, self.at, 0.0, self.hold_s, until_settled=self.until_settled),)


EXPERIMENT = Hold
