"""The experiment that would show what the records could not: effects that they did not excite, or only if large."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from control.design import DesignModel
from control.experiment import Experiment
from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult
from twin.diagnosis import EffectTest
from twin.model.catalog import effects
from twin.model.effect import Parameter, Scales
from twin.model.plant import Inserted
from twin.next.candidates import library
from twin.next.criterion import Scale, effect_distance, lay_out, response
from twin.next.limits import Limits
from twin.next.rivals import Rival, rival_of
from twin.next.search import value_of

#: Experiments that are looked at in full; the library comes sorted by length.
_LOOKED_AT = 20


@dataclass(frozen=True, slots=True)
class BlindSpot:
    """An effect in a form and of a clear size (record units) that the records would not have shown."""

    name: str
    inserted: Inserted


@dataclass(frozen=True, slots=True)
class Coverage:
    """An experiment, and the blind spots that it would take away."""

    experiment: Experiment
    shown: tuple[str, ...]
    value: float


def blind_spots(tests: Sequence[EffectTest], scales: Scales, design: DesignModel) -> list[BlindSpot]:
    """Effects that are not testable, or only where they are larger than clear on a valve of this design."""
    spots = []
    for test in tests:
        if test.name not in effects():
            continue
        effect = effects()[test.name]
        form = effect.form(test.form) if test.form else effect.forms[0]
        clear = tuple(_clear(p, scales, design) for p in form.parameters)
        inserted = Inserted(test.name, form, clear)
        main = next((k for k, p in enumerate(form.parameters) if p.name == test.parameter), None)
        hidden = main is not None and _beyond(form.parameters[main], clear[main], test, scales)
        if not test.testable or hidden:
            spots.append(BlindSpot(test.name, inserted))
    return spots


def best_coverage(
    result: StageResult, spots: Sequence[BlindSpot], rules: DecisionRules, limits: Limits
) -> Coverage | None:
    """The experiment that shows the most blind spots per minute; None when it would show none."""
    channels = [(d, rival_of(result, d, d.findings.retuned, "design")) for d in result.decisions]
    best: Coverage | None = None
    for experiment in sorted(library(limits), key=lambda e: e.duration_s)[:_LOOKED_AT]:
        shares = _shares(result, experiment, spots, channels, limits, rules)
        shown = tuple(spot.name for spot, share in zip(spots, shares, strict=True) if share >= 1.0)
        value = value_of(shares, 1.0, experiment.duration_s)
        if shown and (best is None or value > best.value):
            best = Coverage(experiment, shown, value)
    return best


def _shares(
    result: StageResult,
    experiment: Experiment,
    spots: Sequence[BlindSpot],
    channels: Sequence[tuple[Decision, Rival]],
    limits: Limits,
    rules: DecisionRules,
) -> list[float]:
    """How much of what a decision asks for each blind spot would bring, 1 is enough; in the order of the spots.

    A cause must be significant, and material over all records together.
    """
    bed = lay_out(experiment, limits.scale)
    shares = dict.fromkeys((spot.name for spot in spots), 0.0)
    known_s = sum(r.duration_s for r in result.case.recordings)
    for decision, design in channels:
        channel = decision.findings.channel
        mine = [spot for spot in spots if effects()[spot.name].stage in channel.stages]
        if not mine:
            continue
        period_s = sum(r.period_s for r in result.case.recordings) / len(result.case.recordings)
        excess = max(decision.findings.retuned.mse, 1.0)
        scale = Scale(channel.name, channel.sigma, max(decision.findings.phi * period_s, 1e-3), excess)
        hidden, plain = response(design, bed, scale), design.plant()
        for spot in mine:
            changed = plain.having([spot.inserted])
            far = effect_distance(design, changed, hidden, bed, scale)
            material = rules.gain * (far.worth + known_s / scale.independent_s)
            shares[spot.name] = min(far.gain / rules.evidence, far.squared / material)
    return [shares[spot.name] for spot in spots]


def weakens(test: EffectTest) -> bool:
    """Whether an effect shows where its parameter is small, as a supply does: nothing is wrong with a high one."""
    form = effects()[test.name].form(test.form) if test.form else effects()[test.name].forms[0]
    main = next((p for p in form.parameters if p.name == test.parameter), None)
    return main is not None and _only_lower(main)


def _only_lower(p: Parameter) -> bool:
    return p.neutral > max(p.starts)


def _clear(p: Parameter, scales: Scales, design: DesignModel) -> float:
    """The value of a clear effect [record units]; shape parameters at their first start.

    A ceiling of the pressure is clear where it costs half of the stroke: what is above all that the valve needs is no
    fault, and nothing could show it.
    """
    value = (_clear_size(p) if p.size else p.starts[0]) * scales.factor(p.kind)
    ceiling = p.size and p.kind == "pressure" and _only_lower(p)
    return min(value, design.a1 + 0.5 * design.travel / design.compliance) if ceiling else value


def _clear_size(p: Parameter) -> float:
    """Half of a large effect, on the side of the starts; the mildest start where they lie far from neutral."""
    nearest = min(p.starts, key=lambda s: abs(s - p.neutral))
    if abs(nearest - p.neutral) > p.scale:
        return nearest
    side = 1.0 if max(p.starts) > p.neutral else -1.0
    return min(max(p.neutral + 0.5 * side * p.scale, p.lower), p.upper)


def _beyond(p: Parameter, clear: float, test: EffectTest, scales: Scales) -> bool:
    """Whether the record shows the effect only where it is larger than clear."""
    neutral = p.neutral * scales.factor(p.kind)
    return test.detection_limit is not None and abs(test.detection_limit - neutral) > abs(clear - neutral)
