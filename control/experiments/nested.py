"""A fine staircase that turns back inside itself: inner loops show what a single play cannot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from control.experiment import Experiment, level, number, seconds, span
from control.experiments.staircase import ladder
from control.step import Step, joined


@dataclass(frozen=True, kw_only=True)
class Nested(Experiment):
    """Up and down between bounds that close in from [low, high] on `centre`, `loops` times, then one full loop.

    The bounds move by equal amounts, so that the reversals lie evenly over both curves; the innermost loop is
    `smallest` wide. With `outward` the same loops are gone through again from the inside out instead.
    """

    kind: ClassVar[str] = "nested"
    low: float = level(4.0, "lowest level of the outer loop")
    high: float = level(13.0, "highest level of the outer loop")
    centre: float = level(8.7, "level that the loops close in on")
    smallest: float = span(2.0, "width of the innermost loop")
    loops: int = number(5, "number of loops, the outer one included", least=2, most=200)
    step: float = span(0.25, "height of a step")
    rise_s: float = seconds(0.0, "time a step takes to rise; 0 jumps")
    dwell_s: float = seconds(4.0, "stay on each step; the longest stay with until_settled", least=0.1)
    outward: bool = False

    def check(self) -> None:
        if not self.low < self.centre < self.high:
            raise self.wrong("centre", self.centre, f"must lie between low = {self.low:g} and high = {self.high:g}")
        if self.smallest >= self.high - self.low:
            raise self.wrong("smallest", self.smallest, f"must be below high - low = {self.high - self.low:g}")

    def turns(self) -> list[float]:
        """The levels at which it turns back, in order, after starting at `low`."""
        inward: list[float] = []
        for loop in range(int(self.loops)):
            share = loop / (self.loops - 1)
            half = 0.5 * self.smallest
            inward.append(self.high + share * (self.centre + half - self.high))
            inward.append(self.low + share * (self.centre - half - self.low))
        # Without the way out, the innermost loop is closed by going all the way up again.
        return inward + inward[::-1] if self.outward else [*inward, self.high]

    def one_pass(self) -> tuple[Step, ...]:
        levels: list[float] = []
        for turn in (*self.turns(), self.low):
            here = levels[-1] if levels else self.low
            if turn != here:
                levels += ladder(here, turn, self.step)
        return tuple(
            joined(tuple(levels), self.low, rise_s=self.rise_s, hold_s=self.dwell_s, until_settled=self.until_settled)
        )


EXPERIMENT = Nested
