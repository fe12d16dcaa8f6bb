"""Causes that do what another one does only together with design numbers that happen to be off just so.

A gauge whose gain is wrong reads a stop where there is none, and the rest of the stroke as it is, if the compliance is
wrong by as much the other way. Both have the same evidence where numbers are believed to a percent; but most machines
have most of their numbers as designed, to far less than that, and then it is a coincidence. It weighs between twins
only. Source: spike and slab, Mitchell, Beauchamp, J. Am. Stat. Assoc. 83 (1988) 1023.
"""

from __future__ import annotations

from dataclasses import replace

from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.weigh import Weights, conspiracy, stands_in
from twin.fit.fitting import Fit


def without_conspiracy(decision: Decision, rules: DecisionRules, weights: Weights) -> Decision:
    """The decision with each cause replaced by its twin where only the latter leaves the design's numbers alone."""
    for cause in decision.accepted.space.causes if decision.explained else ():
        twins = cause.effect.twins if cause.effect is not None else ()
        same = [f for f in decision.findings.fits if f.mse <= decision.accepted.mse + rules.plain]
        rivals = [f for f in same for twin in twins if stands_in(f, decision.accepted, cause.name, twin)]
        best = max(rivals, key=decision.findings.score, default=None)
        if best is not None and _likelier(decision, best, weights):
            decision = replace(decision, accepted=best, rest=decision.rest_of(best))
    return decision


def _likelier(decision: Decision, other: Fit, weights: Weights) -> bool:
    lead = decision.findings.score(decision.accepted) - decision.findings.score(other)
    return conspiracy(decision.accepted, other, decision.findings.phi) > max(lead, 0.0) / weights.temperature
