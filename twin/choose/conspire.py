"""Causes that do what another one does only together with design numbers that happen to be off just so.

A gauge whose gain is wrong reads a stop where there is none, and the rest of the stroke as it is, if the compliance is
wrong by as much the other way. Both have the same evidence where numbers are believed to a percent; but most machines
have most of their numbers as designed, to far less than that, and then it is a coincidence. It weighs between twins
only, and between forms of one cause before that: which of them a search went on with is chance, where both do the same.
Source: spike and slab, Mitchell, Beauchamp, J. Am. Stat. Assoc. 83 (1988) 1023.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from twin.choose.decide import FREE, Decision
from twin.choose.in_place import in_place_of
from twin.choose.rules import DecisionRules
from twin.choose.weigh import Weights, conspiracy, stands_in
from twin.fit.fitting import Fit
from twin.fit.space import Cause
from twin.search.candidates import effect_causes


def without_conspiracy(decision: Decision, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision with each cause replaced by its twin where only the latter leaves the design's numbers alone."""
    for cause in decision.accepted.space.causes if decision.explained else ():
        if _likelier_twin(decision, cause, rules, weights) is None:
            continue
        decision = _in_sparing_form(decision, cause, rules, weights)
        # a free curve finds something to spare the numbers with, in the place of a law
        laws = len(decision.accepted.space.unknowns) + FREE
        best = _likelier_twin(decision, cause, rules, weights, laws)
        if best is not None:
            decision = replace(decision, accepted=best, rest=decision.rest_of(best))
    return decision


def _likelier_twin(
    decision: Decision, cause: Cause, rules: DecisionRules, weights: Weights, below: float = np.inf
) -> Fit | None:
    """The likeliest hypothesis with a twin in the place of a cause, if it is the likelier one for the numbers.

    `below`: so many unknowns it must not have.
    """
    twins = cause.effect.twins if cause.effect is not None else ()
    same = [f for f in decision.findings.fits if f.mse <= decision.accepted.mse + rules.plain]
    rivals = [f for f in same for twin in twins if stands_in(f, decision.accepted, cause.name, twin)]
    rivals = [f for f in rivals if len(f.space.unknowns) < below]
    best = max(rivals, key=decision.findings.score, default=None)
    return best if best is not None and _likelier(decision, best, weights) else None


def _in_sparing_form(decision: Decision, cause: Cause, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision with a cause in another form of no more numbers, if that leaves the design's alone and does as well.

    Friction that grows along the stroke about its middle is two springs that are not alike, and a deadband that is off.
    """
    accepted, findings = decision.accepted, decision.findings
    others = [c for c in effect_causes(findings.channel, accepted.space.base) if _no_freer(c, cause)]
    fits = in_place_of(decision, cause, others)
    near = [f for f in fits if f.mse <= accepted.mse + rules.plain and _likelier(decision, f, weights)]
    best = max(near, key=findings.score, default=None)
    return decision if best is None else replace(decision, accepted=best, rest=decision.rest_of(best))


def _no_freer(other: Cause, cause: Cause) -> bool:
    """Whether it is the same cause in another known form of no more numbers."""
    if other.name != cause.name or other.form is None or cause.form is None or other.form is cause.form:
        return False
    return not other.form.outside and len(other.form.parameters) <= len(cause.form.parameters)


def _likelier(decision: Decision, other: Fit, weights: Weights) -> bool:
    lead = decision.findings.score(decision.accepted) - decision.findings.score(other)
    return conspiracy(decision.accepted, other, decision.findings.phi) > max(lead, 0.0) / weights.temperature
