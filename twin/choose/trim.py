"""Leaves out causes that are less likely than not, where the others explain the gap without them.

Something beside the sure causes may be real and its name a guess: several further causes then do almost as well, and
none of them reaches an even chance. Naming one would be wrong more often than right.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from twin.choose.alike import alike
from twin.choose.decide import Decision, with_numbers
from twin.choose.idle import idle
from twin.choose.plainer import effects_of, slack_of
from twin.choose.reach import moved_square
from twin.choose.rules import DecisionRules
from twin.choose.weigh import Weights, weigh
from twin.fit.fitting import Fit
from twin.model.catalog import effects
from twin.search.claims import size_of
from twin.search.findings import Findings
from twin.search.needless import rival_in
from twin.search.search_rules import SLIGHT

#: A cause that is, with its twins, less likely than this is not named, unless one rival and it have as much as `BOTH`.
LIKELY, BOTH = 0.45, 0.85
#: Mean squared residual of a pressure up to which it passes for healthy, where a wrong number is all that its error
#: needs: twice the noise.
_SLIGHT_NUMBER = 4.0
#: Times the noise: a gap as large is no small rest, and an answer that is silent about it is none.
_PLAIN = 10.0


def belief(name: str, probability: Mapping[str, float], here: Collection[str] = ()) -> float:
    """The probability of a cause, or one of its twins, which no record of these signals could tell from it.

    `here`: those that the records at hand cannot tell from it either (see `alike`).
    """
    return sum(probability.get(other, 0.0) for other in _one_with(name, here))


def _one_with(name: str, here: Collection[str]) -> set[str]:
    """A cause with its twins, and with those that the records at hand cannot tell from it."""
    one = effects().get(name)
    twins = {twin for names in one.same_as.values() for twin in names} if one is not None else set()
    return {name, *twins, *here}


def doubtful(name: str, probability: Mapping[str, float], here: Collection[str], sets: Sequence[Sequence[str]]) -> bool:
    """Whether naming a cause would be wrong more often than right: it is less likely than not, and no one of two.

    `here`: as in `belief`; `sets`: as in `Weighed`. Where a cause and a single rival hold all of the belief, the two
    are sure, and the one is named with its set.
    """
    believed = belief(name, probability, here)
    rivals = {rival for members in sets if members[0] == name for rival in members} - _one_with(name, here)
    nearest = max((probability.get(rival, 0.0) for rival in rivals), default=0.0)
    return believed < LIKELY and believed + nearest < BOTH


def trimmed(decision: Decision, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision without its unlikely causes; as it was where the rest would leave the gap unexplained.

    Nor is one taken twice: an effect goes, the number that stood for it comes, goes for the effect, and so on.
    """
    taken = {frozenset(decision.names)}
    while decision.explained and len(decision.names) > 1:
        probability = weigh(decision, weights).probability
        beliefs = {name: belief(name, probability, alike(decision, name)) for name in decision.names}
        weakest = min(beliefs, key=lambda name: beliefs[name])
        if beliefs[weakest] >= LIKELY:
            break
        smaller = _without(decision, weakest, rules.evidence)
        if smaller is None:
            break
        rest = decision.rest_of(smaller)
        if rest >= rules.unexplained and smaller.mse >= rules.nothing_left * decision.floor:
            break
        smaller = _instead(decision.findings, smaller, rules)
        if frozenset(smaller.names) in taken:
            break
        taken.add(frozenset(smaller.names))
        decision = replace(decision, accepted=smaller, rest=decision.rest_of(smaller))
    return decision


def _instead(findings: Findings, smaller: Fit, rules: DecisionRules) -> Fit:
    """The best hypothesis of that size where it is clearly likelier: beside the cause that went, `smaller` was needed
    only. Not one whose effects do no more than re-tuning does: it stands for the number that went."""
    best = findings.best_of_size(size_of(smaller))
    if best is None or findings.score(best) <= findings.score(smaller) + rules.evidence:
        return smaller
    return smaller if idle(findings, best, slack_of(findings, rules)) else best


def dropped(decision: Decision, name: str) -> Decision | None:
    """The decision without one of its causes, whatever that leaves; None where the others were never tried alone."""
    if decision.names == (name,):
        return silent(decision)
    smaller = _without(decision, name, DecisionRules().evidence)
    return None if smaller is None else replace(decision, accepted=smaller, rest=decision.rest_of(smaller))


def _without(decision: Decision, name: str, evidence: float) -> Fit | None:
    """The best hypothesis with the other causes of the accepted one.

    With the numbers accused that stood for an effect while it was there: some take a number along as their own.
    """
    kept = sorted(set(decision.names) - {name})
    fits = [f for f in decision.findings.fits if sorted(f.names) == kept]
    best = max(fits, key=decision.findings.score, default=None)
    if best is None or name not in effects():
        return best
    return with_numbers(decision.findings, best, evidence)


def spoken(decisions: Sequence[Decision], weights: Weights, seen: bool) -> tuple[Decision, ...]:
    """The decisions without what is a guess, or about hardly anything, on a channel beside what is sure.

    `seen`: the readings themselves showed a cause. Beside what is sure a small rest may fit half of the catalogue
    equally well; naming one of them would be wrong more often than right. Not where the rest is ten times the noise: a
    guess, with its set, says more of that than nothing. And no machine is its design to the last percent: where a
    signal alone would pass for healthy, what explains the rest of it is no fault, unless it moves the stem so far that
    the position would not. It makes no answer either of a guess about a clear gap behind it. And a pressure that passes
    for healthy and resembles something from outside of the vocabulary wanders a little, and so does one that nobody
    measured, where the stem passes for healthy.
    """
    guesses = [_guess(d, weights) for d in decisions]
    slight = [_slight(d) and not _reaches(d, decisions) for d in decisions]
    gaps = [bool(d.names) and not little for d, little in zip(decisions, slight, strict=True)]
    clear = seen or any(gaps)
    sure = seen or any(gap and not guess for gap, guess in zip(gaps, guesses, strict=True))
    vague = [little and _wanders(d) for d, little in zip(decisions, slight, strict=True)]
    small = [guess and not _plain(d) for d, guess in zip(decisions, guesses, strict=True)]
    mute = [(sure and g) or (clear and s) or v for g, s, v in zip(small, slight, vague, strict=True)]
    return tuple(silent(d) if one else d for d, one in zip(decisions, mute, strict=True))


def silent(decision: Decision) -> Decision:
    """The decision that there is nothing on this channel."""
    none = decision.findings.none
    return replace(decision, accepted=none, explained=False, gap=False, rest=decision.rest_of(none))


def _slight(decision: Decision) -> bool:
    """Whether the design alone leaves little more than the noise on this channel.

    A steady gauge shows that a converter's lag is 3 % off; numbers that move no stem by that are nobody's fault.
    """
    numbers = decision.findings.channel.name == "pressure" and not effects_of(decision.accepted)
    most = _SLIGHT_NUMBER if numbers else SLIGHT
    return bool(decision.names) and decision.findings.none.mse < most * decision.floor


def _plain(decision: Decision) -> bool:
    """Whether the design alone leaves so much on this channel that nobody could overlook it."""
    return decision.findings.none.mse > _PLAIN**2 * decision.floor


def _wanders(decision: Decision) -> bool:
    """Whether what a pressure does beside the command resembles something from outside of the vocabulary.

    Or what a stem does by it that nobody measured.
    """
    return decision.findings.channel.name != "position" and rival_in(decision.accepted) is not None


def _reaches(decision: Decision, decisions: Sequence[Decision]) -> bool:
    """Whether a pressure that passes for healthy is off by what shows behind the stem."""
    behind = decisions[-1].findings.channel
    if decision.findings.channel.name != "pressure" or behind.name == "pressure":
        return False
    return 1.0 + moved_square(decision, behind.sigma) > SLIGHT


def _guess(decision: Decision, weights: Weights) -> bool:
    """Whether a channel's only cause is, with its twins, less likely than not."""
    if len(decision.names) != 1:
        return False
    [name] = decision.names
    weighed = weigh(decision, weights)
    sets = weighed.sets if decision.exact else ()
    return doubtful(name, weighed.probability, alike(decision, name), sets)
