"""The verdict: what the channels' decisions and the readings' events say together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from twin.choose.alike import alike
from twin.choose.decide import Decision
from twin.choose.outside import outside_of
from twin.choose.stages import StageResult
from twin.choose.weigh import Weighed, Weights, weigh
from twin.diagnosis import Cause, Estimate, Ranked, Verdict
from twin.fit.fitting import Fit
from twin.fit.numbers import unit
from twin.fit.space import Cause as Candidate
from twin.judge.remainder import CLEAR
from twin.judge.repeatable import repeated_share
from twin.record.sensing import Sensing

#: A converter whose pressure is off in a way that none explains matters only if it moves the stem by this share.
MATERIAL_SHARE = 0.25
#: Behind a converter that explains the rest, a share of the gap that needs no cause of its own.
MINOR_SHARE = 0.02
_EVENT_PROBABILITY = 0.98
#: Mean squared residual, noise = 1, that false readings too small to be recognised may leave, or noise that takes
#: readings over the edges of coarse steps: it does so with its cube, and how much of it there is hardly shows in them.
MISSED = 4.0
#: RMS beyond the edges of coarse steps, in steps, of twice the noise up to which they count as sharp: how much there is
#: does not show where a display holds on to its code.
_OVER_EDGES = 0.06
#: Share of its step that a coarse reading keeps from flickering by.
_FLICKER = 0.6
#: Standard deviation of a size that comes from its form being a model, as a share of the size (docs/calibration.md).
FORM_ERROR = 0.015
#: Mean squared residual, noise = 1, that has to be common to repeats before it is a gap of the model.
COMES_BACK = 1.0


@dataclass(frozen=True, slots=True)
class Judgement:
    """The verdict with its causes (sorted by probability), the ranking of all candidates and the confusion sets.

    `alike`: for each cause those that these records cannot tell from it (see `twin.choose.alike`).
    """

    verdict: Verdict
    causes: tuple[Cause, ...]
    ranking: tuple[Ranked, ...]
    confusable: tuple[tuple[str, ...], ...]
    alike: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def pronounce(
    result: StageResult, sensing: Sensing, ep_share: float, weights: Weights, disturbed: bool = False
) -> Judgement:
    """Combines everything. `ep_share` is the converter's share of the reducible position error, 0 if unknown.

    `disturbed`: something does not repeat although it should, or swings by itself; without any cause it is unexplained.
    """
    weighed = [weigh(d, weights) for d in result.decisions]
    causes = _causes(result, weighed, sensing)
    sets = tuple(s for w in weighed for s in w.sets)
    ranking = _ranking(weighed, sensing)
    if _unexplained(result, ep_share, sensing) or any(outside_of(d) for d in result.decisions):
        return Judgement("unexplained", (), ranking, ())
    if not causes:
        return Judgement("unexplained" if disturbed else "no_gap", (), ranking, ())
    same = {name: alike(d, name) for d in result.decisions for name in d.names}
    return Judgement(verdict_of(causes), causes, ranking, sets, same)


def verdict_of(causes: Sequence[Cause]) -> Verdict:
    """What the named causes, of which there is one at least, make the verdict."""
    effects = sum(not c.name.startswith("parameter:") for c in causes)
    return "parameter" if not effects else "effect" if effects == 1 else "effects"


def _unexplained(result: StageResult, ep_share: float, sensing: Sensing) -> bool:
    """Whether a channel with a gap found no cause, and the gap matters for the stem.

    Among false readings there are always some that cannot be told from true ones; what little they add needs no cause,
    nor what is beyond the edges of coarse steps by a little.
    Readings that are seen to be held, but at no fixed period, cannot be predicted, and are a cause all the same.
    """
    for decision in result.decisions:
        if _hidden(decision, sensing):
            continue
        if "stale_samples" in sensing.accepted and (decision.findings.channel.name != "pressure" or sensing.together):
            continue
        wanting = decision.gap and not decision.explained and _comes_back(decision)
        if wanting and not _minor(result, decision, ep_share):
            return True
    return False


def _hidden(decision: Decision, sensing: Sensing) -> bool:
    """Whether a gap is what false readings, or what noise carries over the edges of coarse steps, may add unseen."""
    channel, mse = decision.findings.channel, decision.findings.none.mse
    steps = channel.half > 0.0
    over_edges = steps and np.sqrt(mse) * channel.sigma < _OVER_EDGES * 2.0 * channel.half
    return over_edges or ((steps or "sensor_dropouts" in sensing.accepted) and mse < MISSED)


def _minor(result: StageResult, decision: Decision, ep_share: float) -> bool:
    """Whether a channel's gap is next to nothing of the whole one: what moves no stem, what another one outweighs."""
    if decision.findings.channel.name == "pressure":
        return ep_share < MATERIAL_SHARE and not strays(result)
    return any(d.explained for d in result.decisions if d is not decision) and 1.0 - ep_share < MINOR_SHARE


def strays(result: StageResult) -> bool:
    """Whether the pressure is clearly off, and the stem says that it is the gauge (see `twin.choose.witness`)."""
    clear = bool(result.denied) or result.decisions[0].findings.none.mse > CLEAR**2 * result.decisions[0].floor
    return result.astray and clear


def _comes_back(decision: Decision) -> bool:
    """Whether the design's error repeats where commands were repeated; taken for granted where none was."""
    none, trials = decision.findings.none, decision.findings.channel.trials
    share = repeated_share(none.residuals, trials)
    return share is None or share * none.mse > COMES_BACK


def _causes(result: StageResult, weighed: list[Weighed], sensing: Sensing) -> tuple[Cause, ...]:
    causes = []
    for decision, weight in zip(result.decisions, weighed, strict=True):
        if not decision.explained:
            continue
        sizes = estimates(decision.accepted, decision.findings.phi)
        for candidate in decision.accepted.space.causes:
            own = {k: v for k, v in sizes.items() if k[0] == candidate.name}
            if _of_the_display(own, sensing):
                continue
            fitted = {label: estimate for (_, label), estimate in own.items()}
            parameters = dict(sensing.accepted.get(candidate.name, {})) | fitted
            seen = _EVENT_PROBABILITY if candidate.name in sensing.accepted else 0.0
            probability = max(weight.probability[candidate.name], seen)
            causes.append(Cause(candidate.name, candidate.stage, probability, None, parameters))
    for name, found in sensing.accepted.items():
        if name not in {c.name for c in causes}:
            causes.append(Cause(name, "sensor", _EVENT_PROBABILITY, None, found))
    return tuple(sorted(causes, key=lambda c: -c.probability))


def _of_the_display(sizes: Mapping[tuple[str, str], Estimate], sensing: Sensing) -> bool:
    """Whether a play of so little is what a coarse reading has itself.

    One that moves on only when the position has left its step by something, so that noise does not make it flicker,
    reads as a play before a converter without that.
    """
    play = sizes.get(("linkage_lost_motion", "play"))
    return play is not None and sensing.sharp and play.value < _FLICKER * sensing.step


def estimates(fit: Fit, phi: float) -> dict[tuple[str, str], Estimate]:
    """Estimates of everything a hypothesis accuses, by (cause, parameter), with 95 % intervals.

    The intervals allow for the correlation and the excess of the residual, and for a form that is not quite true.
    """
    values = fit.values()
    # what is nearer: a supply of 12 psi is not 48 psi away from none because the bounds end at 60
    sizes = np.minimum(np.abs(values - np.array([u.centre for u in fit.space.unknowns])), np.abs(values))
    deviations = np.hypot(fit.errors(phi * max(fit.mse, 1.0)), FORM_ERROR * sizes)
    bounds = [(u.centre + u.unit * u.lower, u.centre + u.unit * u.upper) for u in fit.space.unknowns]
    design = fit.space.base.design
    found: dict[tuple[str, str], Estimate] = {}
    for k, name in enumerate(fit.space.numbers):
        if f"parameter:{name}" in fit.names:
            label = (f"parameter:{name}", name)
            found[label] = _estimate(values[k], deviations[k], bounds[k], unit(design, name))
    at = len(fit.space.numbers)
    for candidate in fit.space.causes:
        for offset, (name, its_unit) in enumerate(_parameters(candidate, fit)):
            k = at + offset
            found[(candidate.name, name)] = _estimate(values[k], deviations[k], bounds[k], its_unit)
        at += len(candidate.form.parameters) if candidate.form else 0
    return found


def _parameters(candidate: Candidate, fit: Fit) -> list[tuple[str, str]]:
    if candidate.form is None:
        return []
    return [(p.name, fit.space.scales.unit(p.kind)) for p in candidate.form.parameters]


def _estimate(value: float, deviation: float, bounds: tuple[float, float], its_unit: str) -> Estimate:
    """The value with its 95 % interval, cut off where the parameter ends."""
    low, high = max(value - 1.96 * deviation, min(bounds)), min(value + 1.96 * deviation, max(bounds))
    return Estimate(float(value), (float(min(low, value)), float(max(high, value))), its_unit)


def _ranking(weighed: list[Weighed], sensing: Sensing) -> tuple[Ranked, ...]:
    probability = {name: p for w in weighed for name, p in w.probability.items()}
    probability |= dict.fromkeys(sensing.accepted, _EVENT_PROBABILITY)
    order = sorted(probability.items(), key=lambda item: -item[1])
    return tuple(Ranked(name, p, None) for name, p in order)
