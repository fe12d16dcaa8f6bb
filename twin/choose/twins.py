"""Which of two causes that no record can tell apart is named: the one whose size and form are the more usual.

What is known of such a pair is known beforehand, from other machines: a filter behind a sensor is mostly short, and of
one pole; a second lag of a valve mostly long, and it acts before the stem as often as behind it. A record that tells a
valve's forms apart, and asks for the one that is the filter's as well, speaks for the filter. That weighs between
twins only; everything else is decided by the record.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from twin.choose.conspire import without_conspiracy
from twin.choose.decide import Decision
from twin.choose.in_place import in_place_of
from twin.choose.rules import DecisionRules
from twin.choose.trim import trimmed
from twin.choose.usual import log_usual
from twin.choose.weigh import Weights, stands_in, twins_of
from twin.fit.fitting import Fit
from twin.fit.space import Cause
from twin.model.catalog import effects


def with_usual_twins(decision: Decision, weights: Weights) -> Decision:
    """The decision with each cause replaced by its twin where that is the likelier by its size and form."""
    for cause in decision.accepted.space.causes if decision.explained else ():
        for twin in filter(_of_known_size, twins_of(decision.accepted, cause.name)):
            others = in_place_of(decision, cause, _same(twin, cause.name))
            told, other = _with_twin(decision, cause, twin, others)
            own = [decision.accepted, *in_place_of(decision, cause, _other_forms(cause, twin))]
            if _more_usual(told, (cause.name, own), (twin, [other, *others]), weights):
                decision = replace(told, accepted=other, rest=told.rest_of(other))
                break
    return decision


def settled(decision: Decision, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision without its unlikely causes, each of the others under its likelier name."""
    return with_usual_twins(without_conspiracy(trimmed(decision, rules, weights), rules, weights), weights)


def _of_known_size(name: str) -> bool:
    """Whether anything is known of the sizes of an effect on other machines."""
    return any(p.usual is not None for form in effects()[name].forms for p in form.parameters)


def _same(name: str, twin: str) -> list[Cause]:
    """An effect in every form that is the same as another effect."""
    effect = effects()[name]
    return [Cause(name, effect, form) for form in effect.forms if twin in effect.same_as.get(form.name, ())]


def _other_forms(cause: Cause, twin: str) -> list[Cause]:
    return [other for other in _same(cause.name, twin) if other.form is not cause.form]


def _with_twin(decision: Decision, cause: Cause, twin: str, fits: Sequence[Fit]) -> tuple[Decision, Fit]:
    """The decision that has also tried `twin` in the place of `cause`, in every form that is its twin (`fits`).

    Alone it was perhaps best in another form, which is all that the search goes on with. Returns the best hypothesis
    with it too, which takes the place of any that was known.
    """
    accepted, known = decision.accepted, decision.findings.fits
    alike = [f for f in (*known, *fits) if stands_in(f, accepted, cause.name, twin)]
    best = max(alike, key=decision.findings.score)
    others = tuple(f for f in known if not stands_in(f, accepted, cause.name, twin))
    return replace(decision, findings=replace(decision.findings, fits=(*others, best))), best


def _more_usual(
    decision: Decision, own: tuple[str, Sequence[Fit]], other: tuple[str, Sequence[Fit]], weights: Weights
) -> bool:
    """Whether the other cause is the likelier one: each with its hypotheses, which are of its forms."""
    return _log_likely(decision, *other, weights) > _log_likely(decision, *own, weights)


def _log_likely(decision: Decision, name: str, fits: Sequence[Fit], weights: Weights) -> float:
    """What the record says for a cause, and how usual that is, in its forms together; each counts where it is best."""
    forms: dict[str, float] = {}
    for fit in fits:
        form = next(c.form for c in fit.space.causes if c.name == name)
        told = decision.findings.score(fit) / weights.temperature + log_usual(fit, name)
        key = "" if form is None else form.name
        forms[key] = max(told, forms.get(key, -np.inf))
    return float(np.logaddexp.reduce(list(forms.values())))
