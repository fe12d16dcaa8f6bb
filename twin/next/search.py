"""Finds the experiment that separates the most per minute of bench time: the library first, then its free numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from control.experiment import Experiment
from twin.next.candidates import LONGEST_S, library, neighbours, repeated
from twin.next.criterion import Distance, Scale, bound, distance, lay_out, refitted
from twin.next.limits import Limits
from twin.next.rivals import Dispute

#: Bench time that starting an experiment takes, whatever its length [min].
_SETUP_MIN = 1.0
#: Experiments whose free numbers are varied, and rounds of it.
_BEST, _ROUNDS = 2, 2
_MOST_REPEATS = 4


@dataclass(frozen=True, slots=True)
class Found:
    """An experiment with the distances that it would bring, in the order of the dispute's rivals; `value` a minute."""

    experiment: Experiment
    distances: tuple[Distance, ...]
    value: float


def value_of(gains: Sequence[float], needed: float, duration_s: float) -> float:
    """Shares of what is needed, summed over the rivals, per minute; more than enough counts no more than enough."""
    return sum(min(gain / needed, 1.0) for gain in gains) / (duration_s / 60.0 + _SETUP_MIN)


def best_experiment(dispute: Dispute, scale: Scale, limits: Limits, needed: float) -> Found:
    """The most valuable experiment for a dispute with at least one rival; `needed` is the gain that settles it."""
    evaluate = _evaluator(dispute, scale, limits, needed)
    found = _from_library(dispute, scale, limits, needed, evaluate)
    for _ in range(_ROUNDS):
        known = {one.experiment for one in found}
        more = [n for one in found[:_BEST] for n in neighbours(one.experiment, limits)]
        found = _sorted([*found, *(evaluate(e) for e in dict.fromkeys(more) if e not in known)])
    long = [_long_enough(one, needed, evaluate) for one in found[:_BEST]]
    return _sorted([_verified(one, dispute, scale, limits, needed) for one in long])[0]


Evaluate = Callable[[Experiment], Found]


def _evaluator(dispute: Dispute, scale: Scale, limits: Limits, needed: float) -> Evaluate:
    def evaluate(experiment: Experiment) -> Found:
        bed = lay_out(experiment, limits.scale)
        distances = tuple(distance(dispute.accepted, rival, bed, scale) for rival in dispute.rivals)
        value = value_of([d.gain for d in distances], needed, experiment.duration_s)
        return Found(experiment, distances, value)

    return evaluate


def _from_library(dispute: Dispute, scale: Scale, limits: Limits, needed: float, evaluate: Evaluate) -> list[Found]:
    """The best of the library, found by branch and bound: without re-fitting no experiment is worth less."""
    plant = dispute.accepted.plant()
    rivals = [rival.plant() for rival in dispute.rivals]
    promises = []
    for experiment in library(limits):
        bed = lay_out(experiment, limits.scale)
        gains = [bound(plant, rival, bed, scale).gain for rival in rivals]
        promises.append((value_of(gains, needed, experiment.duration_s), experiment))
    found: list[Found] = []
    for promise, experiment in sorted(promises, key=lambda pair: -pair[0]):
        if len(found) >= _BEST and promise <= found[_BEST - 1].value:
            break
        found = _sorted([*found, evaluate(experiment)])
    return found


def _long_enough(one: Found, needed: float, evaluate: Evaluate) -> Found:
    """The experiment repeated as often as it takes to settle the dispute, within the limits of patience."""
    least = max((d.gain for d in one.distances), default=0.0)
    if least >= needed or least <= 0.0:
        return one
    room = int(LONGEST_S // one.experiment.duration_s)
    times = min(int(-(-needed // least)), _MOST_REPEATS, max(room, 1))
    return evaluate(repeated(one.experiment, times)) if times > 1 else one


def _verified(one: Found, dispute: Dispute, scale: Scale, limits: Limits, needed: float) -> Found:
    """The same with each rival really fitted again: the smaller of both distances counts."""
    bed = lay_out(one.experiment, limits.scale)
    again = [refitted(dispute.accepted, rival, bed, scale) for rival in dispute.rivals]
    least = tuple(min(pair, key=lambda d: d.squared) for pair in zip(one.distances, again, strict=True))
    return Found(one.experiment, least, value_of([d.gain for d in least], needed, one.experiment.duration_s))


def _sorted(found: Sequence[Found]) -> list[Found]:
    return sorted(found, key=lambda one: -one.value)
