"""Puts a diagnosis together out of what was judged and measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version

from logs.recording import DataNote
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult
from twin.diagnosis import Cause, Diagnosis, Where
from twin.fit.case import Case
from twin.judge.detectable import detection_limits, unseen_in_windows
from twin.judge.gap import GapParts
from twin.judge.ranking import ranked
from twin.judge.repeatable import Disturbance
from twin.judge.verdict import Judgement
from twin.model.catalog import effects
from twin.model.plant import Plant
from twin.record.sensing import smallest_seen
from twin.report.statement import statement
from twin.where.closure import floor_doubt, gap, rms
from twin.where.isolability import describe


def assembled(
    case: Case,
    result: StageResult,
    judgement: Judgement,
    final: Plant,
    where: Where,
    parts: GapParts,
    loud: Disturbance | None,
    rules: DecisionRules,
    notes: Sequence[DataNote],
) -> Diagnosis:
    """Everything but what comes next: `final` is the updated model, `loud` what should repeat and does not."""
    floor = _floor(case, parts, judgement, loud)
    memory = case.noise.position.correlation_samples
    doubt = floor_doubt(case.noise.position)
    channels = [d.findings.channel for d in result.decisions]
    limits = detection_limits(channels, case.base, case.scales, tuple(effects().values()), rules)
    limits = unseen_in_windows(limits, channels[-1], case)
    diagnosis = Diagnosis(
        verdict=judgement.verdict,
        statement="",
        causes=_causes(judgement, parts, final),
        ranking=ranked(result, judgement, parts.alone),
        gap=gap(parts.before, parts.retuned, parts.after, floor, case.travel, memory, doubt),
        where=where,
        confusable=judgement.confusable,
        data_quality=(*case.notes, *notes),
        effects_tested=(*limits, *smallest_seen(case.noise, case.scales, case.travel)),
        structure=tuple(describe(case.signals)),
        noise=_noise(case),
        spoken=case.scales.spoken,
        version=_version(),
    )
    return replace(diagnosis, statement=statement(diagnosis))


def _causes(judgement: Judgement, parts: GapParts, final: Plant) -> tuple[Cause, ...]:
    """The causes, each with the error without it and the form in which the updated model has it."""
    forms = {one.effect: one.form.name for one in final.inserted}
    return tuple(
        replace(c, heldout_gap_without=parts.without.get(c.name), form=forms.get(c.name, "")) for c in judgement.causes
    )


def _floor(case: Case, parts: GapParts, judgement: Judgement, loud: Disturbance | None) -> float:
    """The noise of the position; where named causes predict better than repeats agree, no more than is left.

    What does not repeat, and should, is a gap and no floor.
    """
    if not judgement.causes:
        return loud.resting if loud is not None and loud.signal == "position" else case.sigma_y
    resting = case.noise.position.resting
    return case.sigma_y if resting is None else min(case.sigma_y, max(rms(parts.after), resting))


def _noise(case: Case) -> dict[str, object]:
    """The noise as measured, with where it was measured."""
    signals = {"position": case.noise.position, "pressure": case.noise.pressure}
    units = {"position": case.scales.position_unit, "pressure": case.scales.pressure_unit}
    return {
        name: {
            "sigma": one.sigma,
            "unit": units[name],
            "source": one.source,
            "correlation_samples": one.correlation_samples,
        }
        for name, one in signals.items()
        if one is not None
    }


def _version() -> str:
    try:
        return version("lostmotion")
    except PackageNotFoundError:
        return "unknown"
