"""Judging a result: what is pronounced, and what of it unseen data leave standing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from twin.case import Case
from twin.choose.trim import dropped, spoken
from twin.choose.weigh import Weights
from twin.fit.fitting import Fit
from twin.gap import GapParts, heldout_parts, idle_cause
from twin.sensing import Sensing
from twin.stages import StageResult
from twin.verdict import Judgement, pronounce

Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True)
class Hearing:
    """What judging a result takes, besides the result."""

    case: Case
    retuned: Fit
    sensing: Sensing
    ep_share: float
    weights: Weights
    disturbed: bool

    def judgement(self, result: StageResult) -> Judgement:
        """The verdict on a result."""
        return pronounce(result, self.sensing, self.ep_share, self.weights, self.disturbed)

    def held_out(
        self, result: StageResult, judgement: Judgement, progress: Progress
    ) -> tuple[StageResult, Judgement, GapParts]:
        """Everything on unseen data, without the causes that are of no use there."""
        parts = heldout_parts(self.case, result, judgement, self.retuned, self.sensing, progress)
        while idle := idle_cause(parts, judgement, result, self.case.travel):
            decisions = tuple(dropped(d, idle) if idle in d.names else d for d in result.decisions)
            if any(d is None for d in decisions):
                break
            left = tuple(d for d in decisions if d is not None)
            result = replace(result, decisions=spoken(left, self.weights, bool(self.sensing.accepted)))
            judgement = self.judgement(result)
            parts = heldout_parts(self.case, result, judgement, self.retuned, self.sensing, progress)
        return result, judgement, parts
