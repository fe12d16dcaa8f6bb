"""A diagnosis from recordings to verdict: data quality, noise, stages, causes, held-out gap, where-map, what next."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import PackageNotFoundError, version

from control.design import DesignModel
from logs.recording import DataNote, FloatArray, Recording
from twin.admit import admit
from twin.case import Case, Margin, make_case, widened
from twin.catalog import effects
from twin.choose.decide import DecisionRules
from twin.choose.search import SearchRules
from twin.choose.trim import trimmed
from twin.choose.weigh import Weights
from twin.closed_loop import closed_loop
from twin.closure import gap, rms
from twin.detectable import detection_limits, unseen_in_windows
from twin.diagnosis import Diagnosis, Where
from twin.effect import Scales
from twin.fit.channel import predict_reading
from twin.fit.fitting import Fit
from twin.gap import GapParts, retuning_pays, upheld
from twin.hearing import Hearing
from twin.lateness import late_commands
from twin.next.propose import propose
from twin.noise.model import estimate_noise
from twin.partial import Interrupted, Stage, known_so_far
from twin.pieces import cut_at_holes
from twin.plant import Inserted, Plant, effect_tables
from twin.refresh import refreshed_together
from twin.repeatable import Disturbance
from twin.rounding import rounding_down
from twin.sensing import Sensing, noise_of_refreshed, sense, smallest_seen
from twin.stages import StageResult, judge
from twin.statement import statement
from twin.thin import look_at, on_everything
from twin.timing import settled_timing
from twin.tuned import retuned_fit
from twin.unexplained import residual_signature
from twin.verdict import Judgement
from twin.wander import unrest
from twin.where.isolability import describe
from twin.whereabouts import whereabouts

Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True)
class Settings:
    """Everything that can be chosen about a diagnosis; the defaults are the calibrated ones.

    With a `margin` a cause must explain more than the margin does. `doubt`: relative standard deviation of the design's
    numbers, wide for those that were identified from the very records.
    """

    search: SearchRules = field(default_factory=SearchRules)
    rules: DecisionRules = field(default_factory=DecisionRules)
    weights: Weights = field(default_factory=Weights)
    seed: int = 0
    margin: Margin = field(default_factory=Margin)
    doubt: float = Scales().doubt


@dataclass(frozen=True, slots=True)
class Outcome:
    """A diagnosis with what a report needs: predictions per recording (reading units) and the updated model."""

    diagnosis: Diagnosis
    recordings: tuple[Recording, ...]
    model: DesignModel
    effect_units: Mapping[str, Mapping[str, str]]
    before: tuple[FloatArray, ...]
    retuned: tuple[FloatArray, ...]
    after: tuple[FloatArray, ...]
    gap: GapParts
    result: StageResult
    next_file: str | None = None


def diagnose(
    recordings: Sequence[Recording],
    design: DesignModel,
    inserted: Sequence[Inserted] = (),
    settings: Settings | None = None,
    progress: Progress = lambda _what, _share: None,
) -> Outcome:
    """Diagnoses recordings of one bench against a design in the same units.

    Raises: `BadInput` when the recordings cannot carry a diagnosis (too short, no motion); `Interrupted`, a
    KeyboardInterrupt with what is known by then.
    """
    settings = settings or Settings()
    recordings, notes = cut_at_holes(recordings)
    noise = estimate_noise(recordings)
    notes += admit(recordings, Plant(design, tuple(inserted)), noise)
    noise = noise_of_refreshed(recordings, noise)
    recordings, timing_notes = settled_timing(recordings, Plant(design, tuple(inserted)), noise)
    progress("noise and events", 1.0)
    sensing = sense(recordings, noise, design.travel, design.rate_limit)
    inserted = (*inserted, *rounding_down(recordings, Plant(design, tuple(inserted)), sensing))
    case = make_case(
        recordings,
        design,
        inserted,
        sensing.bad_rows,
        noise,
        sensing.step,
        _held(recordings, sensing),
        settings.doubt,
    )
    case, share = widened(case, settings.margin)
    settings = replace(settings, rules=replace(settings.rules, gain=max(settings.rules.gain, share)))
    late, late_notes = late_commands(look_at(case)[0])
    case = replace(case, base=Plant(design, (*case.base.inserted, *late)))
    look, look_notes = look_at(case)
    notes += [*timing_notes, *late_notes, *look_notes]
    stage = Stage()
    judgement: Judgement | None = None
    try:
        result = judge(look, settings.search, settings.rules, stage.told(progress))
        sure = tuple(trimmed(d, settings.rules, settings.weights) for d in result.decisions)
        result = replace(result, decisions=sure)
        retuned = retuned_fit(look)
        everything = on_everything(case, result)
        where = whereabouts(case, everything, settings.seed)
        itself = unrest(case, everything, settings.margin.position)
        notes += itself.notes(case)
        case = itself.heard(case)
        converter = where.stage["ep"].value if where.stage and not itself.astray else 0.0
        hearing = Hearing(look, retuned, sensing, converter, settings.weights, itself.disturbed)
        judgement = hearing.judgement(result)
        progress("held-out gap", 0.0)
        needed, judgement, parts = hearing.held_out(result, judgement, stage.told(progress))
        if needed is not result:
            result, everything = needed, replace(everything, decisions=needed.decisions)
            where = whereabouts(case, everything, settings.seed)
        parts, judgement = upheld(parts, judgement, case.sigma_y, sensing, case.sigma_p is not None)
        final = _final_plant(case, result, judgement, retuned if retuning_pays(parts) else None, sensing)
        diagnosis = _assembled(
            case, result, judgement, where, parts, _floor(case, parts, judgement, itself.loud), settings, notes
        )
        proposal = propose(result, judgement, diagnosis.effects_tested, settings.rules, settings.weights)
        loop = closed_loop(recordings, final)
    except KeyboardInterrupt as stop:
        raise Interrupted(known_so_far(case, notes, stage, settings.seed, judgement)) from stop
    plants = (case.base, retuned.plant, final)
    before, again, after = (tuple(predict_reading(p, t) for t in case.trials) for p in plants)
    model, units = _model(Plant(final.design, tuple(i for i in final.inserted if i not in late)), case)
    diagnosis = replace(diagnosis, next_experiment=proposal.next, closed_loop=loop)
    if judgement.verdict == "unexplained":
        diagnosis = replace(diagnosis, residual_signature=residual_signature(case, result, itself.loud, itself.swing))
    return Outcome(diagnosis, tuple(recordings), model, units, before, again, after, parts, everything, proposal.file)


def _held(recordings: Sequence[Recording], sensing: Sensing) -> bool:
    """Whether the position, and not the pressure with it, is seen to be refreshed more slowly than polled."""
    return sensing.held and not any(refreshed_together(r) for r in recordings)


def _final_plant(case: Case, result: StageResult, judgement: Judgement, retuned: Fit | None, sensing: Sensing) -> Plant:
    """The updated model: the design for no gap, re-tuned where unexplained and that pays, with the causes otherwise."""
    if judgement.verdict == "no_gap":
        return case.base
    if judgement.verdict == "unexplained":
        return case.base if retuned is None else retuned.plant
    found = result.plant() if {c.name for c in judgement.causes} - set(sensing.accepted) else case.base
    return found.having(sensing.inserted())


def _assembled(
    case: Case,
    result: StageResult,
    judgement: Judgement,
    where: Where,
    parts: GapParts,
    floor: float,
    settings: Settings,
    notes: Sequence[DataNote],
) -> Diagnosis:
    memory = case.noise.position.correlation_samples
    numbers = gap(parts.before, parts.retuned, parts.after, floor, case.travel, memory, settings.seed)
    causes = tuple(replace(c, heldout_gap_without=parts.without.get(c.name)) for c in judgement.causes)
    ranking = tuple(replace(r, heldout_gap=parts.alone.get(r.name)) for r in judgement.ranking)
    channels = [d.findings.channel for d in result.decisions]
    limits = detection_limits(channels, case.base, case.scales, tuple(effects().values()), settings.rules)
    limits = (*unseen_in_windows(limits, channels[-1], case), *smallest_seen(case.noise, case.scales, case.travel))
    quality = tuple(n for r in case.recordings for n in r.notes) + tuple(notes)
    diagnosis = Diagnosis(
        verdict=judgement.verdict,
        statement="",
        causes=causes,
        ranking=ranking,
        gap=numbers,
        where=where,
        confusable=judgement.confusable,
        data_quality=quality,
        effects_tested=limits,
        structure=tuple(describe(frozenset({"pressure"} if case.sigma_p is not None else set()))),
        noise=_noise(case),
        version=_version(),
    )
    return replace(diagnosis, statement=statement(diagnosis))


def _floor(case: Case, parts: GapParts, judgement: Judgement, loud: Disturbance | None) -> float:
    """The noise of the position; where named causes predict better than repeats agree, no more than is left.

    What does not repeat, and should, is a gap and no floor.
    """
    if not judgement.causes:
        return loud.resting if loud is not None and loud.signal == "position" else case.sigma_y
    known = case.noise.position.by_source
    resting = known.get("still", known.get("straight", case.sigma_y))
    return min(case.sigma_y, max(rms(parts.after), resting))


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


def _model(plant: Plant, case: Case) -> tuple[DesignModel, dict[str, dict[str, str]]]:
    """The plant as a design model file's content, with the units of the effects' parameters."""
    units = {one.effect: {p.name: case.scales.unit(p.kind) for p in one.form.parameters} for one in plant.inserted}
    return replace(plant.design, effects=effect_tables(plant.inserted)), units


def _version() -> str:
    try:
        return version("lostmotion")
    except PackageNotFoundError:
        return "unknown"
