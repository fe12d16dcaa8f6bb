"""A diagnosis from recordings to verdict: data quality, noise, stages, causes, held-out gap, where-map, what next."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.choose.felt import felt_only
from twin.choose.outside import inside
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult, judge
from twin.choose.switches import switch_notes, without_switches
from twin.choose.trim import spoken
from twin.choose.twins import settled
from twin.choose.weigh import Weights
from twin.choose.witness import gauge_note
from twin.diagnosis import Diagnosis
from twin.events.refresh import new_only, refreshed_together
from twin.fit.beginning import start_notes
from twin.fit.case import Case, Margin, make_case, widened
from twin.fit.channel import predict_pressure, predict_reading
from twin.fit.fitting import Fit
from twin.judge.assemble import assembled
from twin.judge.by_condition import gap_by_condition
from twin.judge.closed_loop import closed_loop
from twin.judge.gap import GapParts, retuning_pays
from twin.judge.hearing import Hearing
from twin.judge.moved import moved_numbers
from twin.judge.partial import Interrupted, Known, known_so_far
from twin.judge.repeatable import differ_for_a_cause, leaves_what_rests
from twin.judge.unexplained import residual_signature
from twin.judge.verdict import Judgement
from twin.judge.wander import unrest
from twin.judge.whereabouts import attributed, whereabouts
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant, effect_tables
from twin.next.propose import propose
from twin.noise.blurred import on_their_steps
from twin.noise.copies import used_once
from twin.noise.model import estimate_noise
from twin.ready.lateness import late_commands
from twin.ready.rounding import lacking_codes, rounding_down
from twin.ready.thin import look_at, on_everything
from twin.ready.timing import settled_timing
from twin.ready.tuned import retuned_fit
from twin.record.admit import admit
from twin.record.far_readings import heavy_tail
from twin.record.held_noise import as_reported, noise_of_refreshed
from twin.record.pieces import cut_at_holes
from twin.record.recorder import recorder_note
from twin.record.sensing import Sensing, sense
from twin.report.statement import signed
from twin.search.search_rules import SearchRules

Progress = Callable[[str, float], None]
Prepared = tuple[Case, Case, Sensing, tuple[Inserted, ...]]


@dataclass(frozen=True, slots=True)
class Settings:
    """Everything that can be chosen about a diagnosis; the defaults are the calibrated ones.

    With a `margin` a cause must explain more than the margin does. `doubt`: relative standard deviation of the design's
    numbers, wide for those that were identified from the very records.
    """

    search: SearchRules = field(default_factory=SearchRules)
    rules: DecisionRules = field(default_factory=DecisionRules)
    weights: Weights = field(default_factory=Weights)
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
    pressures: tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]] | None = None  # before and after, if it was read


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
    known = Known(tuple(recordings), Plant(design, tuple(inserted)))
    try:
        return _diagnosed(known, settings, known.told(progress))
    except KeyboardInterrupt as stop:
        so_far = known_so_far(known, settings.weights)
        raise (Interrupted(so_far) if so_far else stop) from stop


def _diagnosed(known: Known, settings: Settings, progress: Progress) -> Outcome:
    """The diagnosis; what it finds out on the way is written into `known`."""
    (case, look, sensing, late), settings, result = _found(known, settings, progress)
    rules, weights = settings.rules, settings.weights
    sure = tuple(without_switches(felt_only(inside(settled(d, rules, weights), rules))) for d in result.decisions)
    result = replace(result, decisions=spoken(sure, weights, bool(sensing.accepted)))
    retuned = retuned_fit(look)
    everything = on_everything(case, result)
    where = whereabouts(case, everything.trials)
    itself = unrest(case, everything, settings.margin.position)
    gauge = [gauge_note(case, result.decisions[0].findings.none.mse, result.denied)] if result.astray else []
    known.notes += [*itself.notes(case), *gauge]
    case = itself.heard(case)
    converter = where.stage["ep"].value if where.stage and not itself.astray else 0.0
    hearing = Hearing(look, retuned, sensing, converter, weights, itself.disturbed, itself.swing is not None)
    known.judgement = hearing.judgement(result)
    progress("held-out gap", 0.0)
    result, judgement, parts = hearing.held_out(result, known.judgement, progress, case.sigma_y)
    everything = replace(everything, decisions=result.decisions)
    known.judgement = judgement
    if judgement.verdict != "no_gap":
        known.notes += hearing.notes(result, judgement, parts)
    judgement = replace(judgement, causes=known.slack.loosened(judgement.causes))
    where = replace(where, attributed=attributed(case, everything, [c.name for c in judgement.causes]))
    final = _final_plant(case, result, judgement, retuned if retuning_pays(parts) else None, sensing)
    known.notes += switch_notes(result.decisions, case.base, final)
    known.notes += moved_numbers(case.base.design, final.design, [c.name for c in judgement.causes])
    diagnosis = assembled(case, result, judgement, final, where, parts, itself.loud, rules, known.notes)
    floor = diagnosis.gap.noise_floor * case.travel / 100.0
    apart = gap_by_condition(result, retuned, floor) if judgement.causes else None
    proposal = propose(result, judgement, diagnosis.effects_tested, rules, weights)
    loop = closed_loop(known.recordings, final)
    plants = (case.base, retuned.plant, final)
    before, again, after = (tuple(predict_reading(p, t) for t in case.trials) for p in plants)
    model, units = _model(Plant(final.design, tuple(i for i in final.inserted if i not in late)), case)
    diagnosis = replace(diagnosis, next_experiment=proposal.next, closed_loop=loop, gap_by_condition=apart)
    if judgement.verdict == "unexplained":
        diagnosis = signed(diagnosis, residual_signature(case, result, itself.loud, itself.swing))
    shown = (diagnosis, known.recordings, model, units, before, again, after, parts, everything)
    return Outcome(*shown, proposal.file, _pressures(case, final))


def _pressures(case: Case, final: Plant) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]] | None:
    """What the given and the updated model make of the pressure, per recording; None where none was read."""
    if case.sigma_p is None:
        return None
    before, after = (tuple(predict_pressure(p, t) for t in case.trials) for p in (case.base, final))
    return before, after


def _found(known: Known, settings: Settings, progress: Progress) -> tuple[Prepared, Settings, StageResult]:
    """What the search found, with what it was made on, and the settings that the margin makes of the given ones.

    Where a cause explains why repeats differ, their difference is no noise: all is searched once more with that of the
    resting reading, in which smaller causes show, and what comes of it holds if it leaves no more than that.
    """
    given = known.recordings
    first = _searched(known, settings, progress)
    if not differ_for_a_cause(first[2].decisions[-1], first[0][1].noise.position):
        return first
    calm = replace(known, recordings=given, searches=[])  # who stops it now keeps what the first search has found
    again = _searched(calm, settings, progress, repeats=False)
    if not leaves_what_rests(again[2].decisions[-1]):
        return first
    known.take(calm)
    return again


def _searched(
    known: Known, settings: Settings, progress: Progress, repeats: bool = True
) -> tuple[Prepared, Settings, StageResult]:
    prepared, share = _prepared(known, settings, progress, repeats), known.margin_share
    rules = replace(settings.rules, gain=max(settings.rules.gain, share), within=1.0 if share > 0.0 else 0.0)
    settings = replace(settings, rules=rules)
    result = judge(prepared[1], settings.search, settings.rules, progress, watch=known.searches.append)
    return prepared, settings, result


def _prepared(known: Known, settings: Settings, progress: Progress, repeats: bool = True) -> Prepared:
    """The case, the look at it that is searched, what the readings themselves show, and how late commands are."""
    plant = known.plant
    alone, copies = used_once(known.recordings)
    recordings, notes = cut_at_holes(alone)
    notes += copies
    noise = estimate_noise(recordings)
    if not repeats:
        noise = replace(noise, position=estimate_noise(recordings, repeats=False).position)
    recordings, blurred = on_their_steps(recordings, noise.position.sigma, plant.design.spoken)
    noise = estimate_noise(recordings) if blurred else noise
    notes += [*blurred, *admit(recordings, plant, noise)]
    known.recordings, known.notes, known.noise = tuple(recordings), list(notes), noise
    noise = noise_of_refreshed(recordings, noise, repeats)
    recordings, timing_notes, known.slack = settled_timing(recordings, plant, noise)
    known.recordings, known.notes, known.noise = tuple(recordings), [*notes, *timing_notes], noise
    progress("noise and events", 1.0)
    design = plant.design
    sensing = sense(recordings, noise, design)
    on_change = sensing.band > 0.0
    reported, noise = (sensing.inserted(), as_reported(noise)) if on_change else ((), noise)
    inserted = (*plant.having(reported).inserted, *rounding_down(recordings, plant, sensing))
    said = [new_only(r) if sensing.held and refreshed_together(r) else r for r in recordings]
    seen = (
        sensing.bad_rows,
        noise,
        sensing.coarseness,
        sensing.held and not sensing.together,
        sensing.sharp,
        settings.doubt,
    )
    case = make_case(said, design, inserted, *seen)
    known.case, known.margin_share = widened(case, settings.margin)
    late, late_notes = late_commands(look_at(known.case)[0])
    known.case = case = replace(known.case, base=Plant(design, (*case.base.inserted, *late)))
    look, look_notes = look_at(case)
    known.notes += start_notes(case.trials)
    known.notes += [*late_notes, *look_notes, *lacking_codes(recordings, sensing), *heavy_tail(sensing)]
    known.notes += [recorder_note(recordings, sensing.step, design.spoken)] if sensing.recorded else []
    return case, look, sensing, tuple(late)


def _final_plant(case: Case, result: StageResult, judgement: Judgement, retuned: Fit | None, sensing: Sensing) -> Plant:
    """The updated model: the design for no gap, re-tuned where unexplained and that pays, with the causes otherwise."""
    if judgement.verdict == "no_gap":
        return case.base
    if judgement.verdict == "unexplained":
        return case.base if retuned is None else retuned.plant
    named = {c.name for c in judgement.causes}
    # what is only seen in events and has no fit brings nothing that was fitted beside it
    fitted = named & set(result.causes) or named - set(sensing.accepted)
    return sensing.beside(result.plant() if fitted else case.base)


def _model(plant: Plant, case: Case) -> tuple[DesignModel, dict[str, dict[str, str]]]:
    """The plant as a design model file's content, with the units of the effects' parameters."""
    units = {one.effect: {p.name: case.scales.unit(p.kind) for p in one.form.parameters} for one in plant.inserted}
    return replace(plant.design, effects=effect_tables(plant.inserted)), units
