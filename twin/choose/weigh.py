"""Probabilities and confusion sets out of scored hypotheses.

Scores are log-evidences of imperfect models, so their differences overstate what is known; a temperature, measured on
recordings of plants that none of the candidates describes exactly, brings them back to honest odds
(docs/calibration.md). Source: Guo et al., "On Calibration of Modern Neural Networks", ICML 2017 (temperature scaling).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.choose.decide import Decision
from twin.choose.idle import idle
from twin.choose.plainer import slack_of
from twin.choose.rules import DecisionRules
from twin.choose.usual import log_usual
from twin.fit.fitting import Fit
from twin.search.claims import hollow, size_of

#: Half of all machines have a design number as designed, to the first of these (relative standard deviations), the
#: other half to the second; what is off by no more than so many standard errors is not off.
_AS_DESIGNED, _ABOUT, _ERRORS = 0.0015, 0.01, 2.0
#: Nats that this is worth at the most: nobody knows machines so well.
_COINCIDENCE = 3.0
#: Nats that a further wrong number has to be worth to count as a hypothesis of its own.
_COMPANION = 3.0
#: Causes behind one signal of which hardly all are true.
_MANY = 3


@dataclass(frozen=True, slots=True)
class Weights:
    """Chosen on the calibration bank. `temperature` divides score differences; `confusable` is the least odds of a twin
    against the accepted cause; `ceiling` is the highest probability ever claimed where something is left of the signal,
    `exact` where its noise is all that is left, `further` that of a cause beside a larger one behind the same signal,
    `third` where they are two or more beside it (a form that is not quite true asks for company), `twin_ceiling` that
    of a cause which no record of these signals can tell from another."""

    temperature: float = 10.0
    confusable: float = 0.03
    ceiling: float = 0.9
    exact: float = 0.98
    further: float = 0.8
    third: float = 0.5
    twin_ceiling: float = 0.7


@dataclass(frozen=True, slots=True)
class Weighed:
    """`probability` of every cause that was tried; `sets` of causes that this channel cannot tell apart."""

    probability: dict[str, float]
    sets: tuple[tuple[str, ...], ...]


def weigh(decision: Decision, weights: Weights) -> Weighed:
    """Weighs all hypotheses of a channel around the accepted one."""
    fits = comparable(decision)
    scores = np.array([decision.findings.score(f) for f in fits])
    scores = np.minimum(scores, decision.findings.score(decision.accepted))
    odds = np.exp((scores - scores.max()) / weights.temperature)
    odds *= np.exp([_usual(decision.accepted, f, decision.findings.phi) for f in fits])
    odds /= odds.sum()
    names = sorted({name for f in fits for name in f.names})
    raw = {n: float(sum(o for o, f in zip(odds, fits, strict=True) if n in f.names)) for n in names}
    ceiling = weights.exact if decision.exact else weights.ceiling
    probability = {n: min(p, ceiling) for n, p in raw.items()}
    first, beside = leading(decision), weights.further if len(decision.names) < _MANY else weights.third
    for name in decision.names:
        if twins_of(decision.accepted, name):
            probability[name] = min(probability[name], weights.twin_ceiling)
        if name != first:
            probability[name] = min(probability[name], beside)
    return Weighed(probability, _sets(decision, fits, odds, weights))


def leading(decision: Decision) -> str | None:
    """The accepted cause that alone leaves least; None where none was accepted or none was fitted alone."""
    alone = [f for f in decision.findings.fits if len(f.names) == 1 and f.names[0] in decision.names]
    return min(alone, key=lambda f: f.mse).names[0] if alone else None


def _usual(accepted: Fit, fit: Fit, phi: float) -> float:
    """What a twin that stands in the place of an accepted cause has for itself, in nats: its size, and numbers as
    designed.

    Whatever stands beside it, lest a twin beside another rival weigh more than beside the accepted cause.
    """
    gone = [name for name in accepted.names if name not in fit.names]
    pairs = [(name, twin) for name in gone for twin in twins_of(accepted, name) if twin in fit.names]
    usual = sum(log_usual(fit, twin) - log_usual(accepted, name) for name, twin in pairs)
    return usual - (max(conspiracy(fit, accepted, phi), 0.0) if _in_the_place(fit, accepted) else 0.0)


def _in_the_place(fit: Fit, accepted: Fit) -> bool:
    """Whether a hypothesis is the accepted one with twins in the place of some of its effects."""
    gone, new = [c for c in accepted.space.causes if c.name not in fit.names], set(fit.names) - set(accepted.names)
    twins = [set(c.effect.twins) if c.effect is not None else set() for c in gone]
    return bool(gone) and len(new) == len(gone) and all(new & some for some in twins)


def conspiracy(fit: Fit, other: Fit, phi: float) -> float:
    """How many nats speak against `fit`, which needs numbers to be off that `other` leaves as designed."""
    return float(np.clip(_log_designed(other, phi) - _log_designed(fit, phi), -_COINCIDENCE, _COINCIDENCE))


def _log_designed(fit: Fit, phi: float) -> float:
    """Log-density of what the design numbers that are not accused are off by."""
    errors = np.sqrt(np.maximum(phi * np.diag(fit.covariance()), 0.0)) if fit.z.size else np.zeros(0)
    beside = [k for k, n in enumerate(fit.space.numbers) if f"parameter:{n}" not in fit.names]
    off = np.maximum(np.abs(fit.z[beside]) - _ERRORS * errors[beside], 0.0)
    spike, slab = (-0.5 * (off / width) ** 2 - np.log(width) for width in (_AS_DESIGNED, _ABOUT))
    return float(np.logaddexp(spike, slab).sum())


def stands_in(fit: Fit, accepted: Fit, name: str, twin: str) -> bool:
    """Whether a hypothesis is the accepted one with `twin` in the place of `name`."""
    return sorted(fit.names) == sorted({*accepted.names, twin} - {name})


def comparable(decision: Decision) -> list[Fit]:
    """The rivals of the accepted hypothesis: none larger, since what a further cause would gain has been weighed, and
    none whose effect has no size, since it is its numbers that explain the gap.

    Where wrong numbers were accepted, effects are a rival only if they do without moving a number as far. Where nothing
    else was, or an effect that spares the numbers, only if they do more than the numbers that they bring along. What
    was recognised by its slips has none: nothing else makes them.
    """
    accepted = decision.accepted
    if decision.slips is not None:
        return [accepted]
    size = size_of(accepted)
    everything = (decision.findings.none, *decision.findings.fits)
    fits = [f for f in everything if size_of(f) <= size and f is not accepted and not hollow(f, decision.findings.phi)]
    fits = [f for f in fits if not _adds_nothing(decision, f, everything)]
    fits = [f for f in fits if not _leans_on(f, accepted)]
    slack = slack_of(decision.findings, DecisionRules())
    if accepted.names and not (_effects(accepted) and idle(decision.findings, accepted, slack)):
        fits = [f for f in fits if not _effects(f) or not idle(decision.findings, f, slack)]
    return [*fits, accepted]


def _effects(fit: Fit) -> bool:
    return any(c.effect is not None for c in fit.space.causes)


def _adds_nothing(decision: Decision, fit: Fit, everything: Sequence[Fit]) -> bool:
    """Whether fewer wrong numbers do as well: each number would otherwise be believed once for every companion."""
    if len(fit.names) < 2 or _effects(fit):
        return False
    least = decision.findings.score(fit) - _COMPANION
    fewer = [f for f in everything if set(f.names) < set(fit.names) and f.names]
    return any(decision.findings.score(f) >= least for f in fewer)


def _leans_on(fit: Fit, accepted: Fit) -> bool:
    """Whether an effect hypothesis moves an accused number, unaccused, at least half as far as the accusation does."""
    if not _effects(fit):
        return False
    for k, name in enumerate(accepted.space.numbers):
        if f"parameter:{name}" in accepted.names and f"parameter:{name}" not in fit.names:
            moved = fit.z[fit.space.numbers.index(name)] if name in fit.space.numbers else 0.0
            if abs(moved) > 0.5 * abs(accepted.z[k]) and moved * accepted.z[k] > 0.0:
                return True
    return False


def _sets(decision: Decision, fits: Sequence[Fit], odds: np.ndarray, weights: Weights) -> tuple[tuple[str, ...], ...]:
    """For each accepted cause the causes that could stand in its place."""
    accepted = decision.accepted
    own = next(float(o) for o, f in zip(odds, fits, strict=True) if f is accepted)
    found = []
    for name in decision.names:
        others = set(accepted.names) - {name}
        rivals = [
            (float(o), (set(f.names) - others).pop())
            for o, f in zip(odds, fits, strict=True)
            if f is not accepted and len(f.names) == len(accepted.names) and others < set(f.names)
        ]
        near = [rival for o, rival in sorted(rivals, reverse=True) if o > weights.confusable * own]
        members = dict.fromkeys([name, *near, *twins_of(accepted, name)])  # several forms of an effect are one rival
        if len(members) > 1:
            found.append(tuple(members))
    return tuple(found)


def twins_of(accepted: Fit, name: str) -> list[str]:
    """Effects whose signature is the same but for a shape that nobody knows: evidence between them is evidence about
    the shapes that happen to be in the catalogue."""
    cause = next(c for c in accepted.space.causes if c.name == name)
    if cause.effect is None or cause.form is None:
        return []
    return list(cause.effect.same_as.get(cause.form.name, ()))
