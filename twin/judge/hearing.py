"""Judging a result: what is pronounced, and what of it unseen data leave standing."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

from logs.recording import DataNote
from twin.choose.decide import Decision
from twin.choose.likelier import likelier
from twin.choose.outside import outside_of
from twin.choose.stages import StageResult
from twin.choose.trim import dropped, silent, spoken
from twin.choose.weigh import Weights
from twin.fit.case import Case
from twin.fit.fitting import Fit
from twin.judge.by_teeth import by_slips, slips_note
from twin.judge.gap import GapParts, fitted_without, heldout_parts, idle_cause, passes_for_noise
from twin.judge.heldout import tied_note
from twin.judge.tolerance import forgiven, needless_number, within_tolerance
from twin.judge.upheld import (
    DOUBTFUL,
    doubted,
    explained_to_noise,
    nothing,
    shown_beyond_steps,
    shown_by_pressure,
    shows_beyond_steps,
    upheld,
)
from twin.judge.verdict import Judgement, pronounce
from twin.record.sensing import Sensing
from twin.search.claims import nudged
from twin.search.reform import spares_numbers
from twin.where.closure import rms

Progress = Callable[[str, float], None]


def weightiest_first(judgement: Judgement, parts: GapParts, travel: float) -> Judgement:
    """The judgement with its causes sorted by probability, equal ones by the error without them.

    What the readings themselves show and no model predicts stands before those that are as likely.
    """
    before = 100.0 * rms(parts.before) / travel
    causes = sorted(judgement.causes, key=lambda c: (-c.probability, -parts.without.get(c.name, before)))
    return replace(judgement, causes=tuple(causes))


def _slight_rival(result: StageResult) -> bool:
    """Whether what explains a slight gap behind the measured pressure best is none of the known effects."""
    behind = result.decisions[1:]
    return any(outside_of(d) is not None and d.findings.none.mse < DOUBTFUL**2 * d.floor for d in behind)


def _missed(less: Decision, more: Decision) -> bool:
    """Whether a cause that was taken away is missed, whatever unseen data say.

    The numbers have to do what it did, or are off without being accused of it, or steps of a reading hide what it does
    there.
    """
    if less is more:
        return False
    accused = {name.removeprefix("parameter:") for name in more.names}
    bent = spares_numbers(more.accepted, less.accepted) or bool(accused & set(nudged(less.accepted, less.floor)))
    return bent or shows_beyond_steps(more, less.accepted)


@dataclass(frozen=True, slots=True)
class Hearing:
    """What judging a result takes, besides the result."""

    case: Case
    retuned: Fit
    sensing: Sensing
    ep_share: float
    weights: Weights
    disturbed: bool
    swings: bool = False

    def judgement(self, result: StageResult) -> Judgement:
        """The verdict on a result."""
        return pronounce(result, self.sensing, self.ep_share, self.weights, self.disturbed)

    def held_out(
        self, result: StageResult, judgement: Judgement, progress: Progress, floor: float
    ) -> tuple[StageResult, Judgement, GapParts]:
        """Everything on unseen data, without the causes that are of no use there; of causes that are as likely the one
        first without which most of the gap is left. `floor`: see `upheld`. Slips that no path follows are heard last.
        """
        result, judgement, parts = self._heard(result, judgement, progress, floor)
        if (slips := by_slips(self.case, result, judgement.verdict == "unexplained")) is not None:
            result, judgement = slips, self.judgement(slips)
            parts = heldout_parts(self.case, result, judgement, self.retuned, self.sensing, progress)
        return result, weightiest_first(judgement, parts, self.case.travel), parts

    def notes(self, result: StageResult, judgement: Judgement, parts: GapParts) -> list[DataNote]:
        """What has to be said of how it was judged."""
        tied = tied_note([c.name for c in judgement.causes], self.case.base, parts.driven)
        return tied + slips_note(result, self.case.scales.pressure_unit, self.case.scales.spoken)

    def _heard(
        self, result: StageResult, judgement: Judgement, progress: Progress, floor: float
    ) -> tuple[StageResult, Judgement, GapParts]:
        """What unseen data leave standing.

        Where what is behind the pressure would take with it what the pressure shows by itself, that is heard alone; so
        it is where a stem that is hardly off resembles something from outside of the vocabulary.
        """
        result, judgement, parts = self._needed(result, judgement, progress, floor)
        upholds = self._upheld(result, judgement, parts, floor)
        if upholds[1].verdict == "unexplained" and (other := self._believed(result, judgement)) is not None:
            likely = self.judgement(other)
            again = heldout_parts(self.case, other, likely, self.retuned, self.sensing, progress)
            stands = self._upheld(other, likely, again, floor)
            if stands[1].verdict != "unexplained":
                return other, stands[1], stands[0]
        shown = shown_by_pressure(result)
        behind = {c.name for c in judgement.causes} - set(shown)
        if upholds[1].verdict != "unexplained" or not shown or not (behind or _slight_rival(result)):
            return result, upholds[1], upholds[0]
        less = replace(result, decisions=(result.decisions[0], *map(silent, result.decisions[1:])))
        alone = self.judgement(less)
        parts = heldout_parts(self.case, less, alone, self.retuned, self.sensing, progress)
        parts, alone = self._upheld(less, alone, parts, floor)
        return (less, alone, parts) if alone.causes else (result, upholds[1], upholds[0])

    def _believed(self, result: StageResult, judgement: Judgement) -> StageResult | None:
        """The result with likelier causes in the place of those that nobody believes; None where there are none."""
        if not judgement.causes or not doubted(judgement, explained_to_noise(result)):
            return None
        others = [likelier(d) for d in result.decisions]
        if not any(others):
            return None
        return replace(result, decisions=tuple(o or d for o, d in zip(others, result.decisions, strict=True)))

    def _needed(
        self, result: StageResult, judgement: Judgement, progress: Progress, floor: float
    ) -> tuple[StageResult, Judgement, GapParts]:
        parts = heldout_parts(self.case, result, judgement, self.retuned, self.sensing, progress)
        percent, kept = 100.0 * floor / self.case.travel, set[str]()
        while idle := self._idle(result, judgement, parts, percent, kept):
            left = tuple(self._dropped(d, idle) if idle in d.names else d for d in result.decisions)
            if any(_missed(less, d) for d, less in zip(result.decisions, left, strict=True)):
                kept.add(idle)
                continue
            result = replace(result, decisions=spoken(left, self.weights, bool(self.sensing.accepted)))
            judgement = self.judgement(result)
            parts = heldout_parts(self.case, result, judgement, self.retuned, self.sensing, progress)
        return result, judgement, parts

    def _idle(
        self, result: StageResult, judgement: Judgement, parts: GapParts, percent: float, kept: Collection[str]
    ) -> str | None:
        """A cause that unseen data do without, and that need not be `kept`. `percent`: the noise, of travel."""
        asked = replace(parts, without={name: error for name, error in parts.without.items() if name not in kept})
        healthy = passes_for_noise(parts, percent, self.case.travel)
        return idle_cause(asked, judgement, result, self.case.travel, healthy) or needless_number(
            asked, judgement.causes, self._slight(judgement), percent
        )

    def _dropped(self, decision: Decision, name: str) -> Decision:
        """The decision without a cause; the others are fitted without it where they never were."""
        if (smaller := dropped(decision, name)) is not None:
            return smaller
        others = fitted_without(decision, name, self.case)
        findings = replace(decision.findings, fits=(*decision.findings.fits, others))
        return replace(decision, findings=findings, accepted=others, rest=decision.rest_of(others))

    def _upheld(
        self, result: StageResult, judgement: Judgement, parts: GapParts, floor: float
    ) -> tuple[GapParts, Judgement]:
        """`upheld`, with what the result says of the channels, and no number that is within its tolerance."""
        if forgiven(parts, judgement.causes, self._slight(judgement), floor):
            return nothing(parts, judgement, self.disturbed)
        measured, wandering = self.case.sigma_p is not None, result.decisions[-1].floor
        shown = (*shown_by_pressure(result), *shown_beyond_steps(result))
        told = (measured, wandering, self.disturbed, explained_to_noise(result), shown)
        return upheld(parts, judgement, floor, self.sensing, *told, self.swings)

    def _slight(self, judgement: Judgement) -> list[str]:
        return within_tolerance(judgement.causes, self.case.base.design)
