"""Which of two causes that no record can tell apart is named: the one whose size is the more usual.

What is known of such a pair is known beforehand, from other machines: a filter behind a sensor is mostly short, a
second lag of a valve mostly long. It weighs between twins only; everything else is decided by the record.
"""

from __future__ import annotations

from dataclasses import replace

from twin.catalog import effects
from twin.choose.conspire import without_conspiracy
from twin.choose.decide import Decision
from twin.choose.in_place import in_place_of
from twin.choose.rules import DecisionRules
from twin.choose.trim import trimmed
from twin.choose.usual import log_usual
from twin.choose.weigh import Weights, stands_in, twins_of
from twin.fit.fitting import Fit
from twin.fit.space import Cause


def with_usual_twins(decision: Decision, weights: Weights) -> Decision:
    """The decision with each cause replaced by its twin where that is the likelier by its size."""
    for cause in decision.accepted.space.causes if decision.explained else ():
        for twin in filter(_of_known_size, twins_of(decision.accepted, cause.name)):
            told, other = _with_twin(decision, cause, twin)
            if _more_usual(told, other, weights):
                decision = replace(told, accepted=other, rest=told.rest_of(other))
                break
    return decision


def settled(decision: Decision, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision without its unlikely causes, each of the others under its likelier name."""
    return with_usual_twins(without_conspiracy(trimmed(decision, rules, weights), rules, weights), weights)


def _of_known_size(name: str) -> bool:
    """Whether anything is known of the sizes of an effect on other machines."""
    return any(p.usual is not None for form in effects()[name].forms for p in form.parameters)


def _with_twin(decision: Decision, cause: Cause, twin: str) -> tuple[Decision, Fit]:
    """The decision that has also tried `twin` in the place of `cause`, in every form that is its twin.

    Alone it was perhaps best in another form, which is all that the search goes on with. Returns the best hypothesis
    with it too, which takes the place of any that was known.
    """
    accepted, effect = decision.accepted, effects()[twin]
    same = [Cause(twin, effect, form) for form in effect.forms if cause.name in effect.same_as.get(form.name, ())]
    fits = in_place_of(decision, cause, same)
    known = decision.findings.fits
    alike = [f for f in (*known, *fits) if stands_in(f, accepted, cause.name, twin)]
    best = max(alike, key=decision.findings.score)
    others = tuple(f for f in known if not stands_in(f, accepted, cause.name, twin))
    return replace(decision, findings=replace(decision.findings, fits=(*others, best))), best


def _more_usual(decision: Decision, other: Fit, weights: Weights) -> bool:
    """Whether what speaks for the size of `other` outweighs what the record says for the accepted cause."""
    lead = decision.findings.score(decision.accepted) - decision.findings.score(other)
    return log_usual(other) - log_usual(decision.accepted) > lead / weights.temperature
