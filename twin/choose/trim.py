"""Leaves out causes that are less likely than not, where the others explain the gap without them.

Something beside the sure causes may be real and its name a guess: several further causes then do almost as well, and
none of them reaches an even chance. Naming one would be wrong more often than right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from twin.catalog import effects
from twin.choose.claims import size_of
from twin.choose.decide import Decision, DecisionRules
from twin.choose.weigh import Weights, weigh
from twin.fit.fitting import Fit

#: A cause that is, with its twins, less likely than this is not named.
LIKELY = 0.45


def belief(name: str, probability: Mapping[str, float]) -> float:
    """The probability of a cause or one of its twins, which no record of these signals could tell from it."""
    one = effects().get(name)
    twins = {twin for names in one.same_as.values() for twin in names} if one is not None else set()
    return sum(probability.get(other, 0.0) for other in {name, *twins})


def trimmed(decision: Decision, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision without its unlikely causes; as it was where the rest would leave the gap unexplained."""
    while decision.explained and len(decision.names) > 1:
        probability = weigh(decision, weights).probability
        weakest = min(decision.names, key=lambda name: belief(name, probability))
        if belief(weakest, probability) >= LIKELY:
            break
        smaller = _without(decision, weakest)
        if smaller is None:
            break
        rest = decision.rest_of(smaller)
        if rest >= rules.unexplained and smaller.mse >= rules.nothing_left * decision.floor:
            break
        best = decision.findings.best_of_size(size_of(smaller))
        if best is not None and decision.findings.score(best) > decision.findings.score(smaller) + rules.evidence:
            smaller = best  # beside the cause that went it was not needed
        decision = replace(decision, accepted=smaller, rest=decision.rest_of(smaller))
    return decision


def dropped(decision: Decision, name: str) -> Decision | None:
    """The decision without one of its causes, whatever that leaves; None where the others were never tried alone."""
    if decision.names == (name,):
        none = decision.findings.none
        return replace(decision, accepted=none, explained=False, gap=False, rest=decision.rest_of(none))
    smaller = _without(decision, name)
    return None if smaller is None else replace(decision, accepted=smaller, rest=decision.rest_of(smaller))


def _without(decision: Decision, name: str) -> Fit | None:
    """The best hypothesis with the other causes of the accepted one."""
    kept = sorted(set(decision.names) - {name})
    fits = [f for f in decision.findings.fits if sorted(f.names) == kept]
    return max(fits, key=decision.findings.score, default=None)


def spoken(decisions: Sequence[Decision], weights: Weights, seen: bool) -> tuple[Decision, ...]:
    """The decisions without a channel's only cause where that is a guess, and something else is sure.

    `seen`: the readings themselves showed a cause. Beside what is sure a small rest may fit half of the catalogue
    equally well; naming one of them would be wrong more often than right.
    """
    guesses = [_guess(d, weights) for d in decisions]
    sure = seen or any(d.names and not guess for d, guess in zip(decisions, guesses, strict=True))
    kept = []
    for decision, guess in zip(decisions, guesses, strict=True):
        without = dropped(decision, guess) if guess and sure else None
        kept.append(decision if without is None else without)
    return tuple(kept)


def _guess(decision: Decision, weights: Weights) -> str:
    """The name of a channel's only cause if it is, with its twins, less likely than not; else nothing."""
    if len(decision.names) != 1:
        return ""
    [name] = decision.names
    return name if belief(name, weigh(decision, weights).probability) < LIKELY else ""
