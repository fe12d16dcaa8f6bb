"""Rivals that are none of the known effects: where one of them explains best, nothing known does.

Without them the nearest known effect would be named for what it only resembles: a zero that jumps is no drift.
"""

from __future__ import annotations

from dataclasses import replace

from twin.choose.decide import Decision
from twin.choose.plainer import effects_of
from twin.choose.rules import DecisionRules
from twin.choose.trim import dropped
from twin.fit.fitting import Fit
from twin.fit.space import Cause
from twin.search.needless import LEAVES, rival_in

#: Error, noise = 1, beyond which wrong numbers alone do not explain a gap, however large: the model is what the design
#: says, and no form of theirs can be at fault. Of 75 that were right on the last checks and plants the worst left 1.32;
#: beside none, where a spring broke, 4.3.
NUMBERS_LEAVE = 2.0


def outside_of(decision: Decision) -> Cause | None:
    """What is accepted and lies outside of the vocabulary, if anything."""
    return rival_in(decision.accepted) if decision.explained else None


def inside(decision: Decision, rules: DecisionRules) -> Decision:
    """The decision without what lies outside, where the known causes explain the gap as well, or those beside it do."""
    rival = outside_of(decision)
    if rival is None:
        return decision
    known = _as_well(decision, rules)
    if known is not None:
        return replace(decision, accepted=known, rest=decision.rest_of(known))
    smaller = dropped(decision, rival.name)
    if smaller is None or not smaller.names or smaller.rest >= LEAVES or _numbers_fall_short(smaller):
        return decision
    return smaller


def _as_well(decision: Decision, rules: DecisionRules) -> Fit | None:
    """The same causes in known forms of no more numbers, if what the rival does better is next to nothing of the gap,
    and less evidence than any cause has to be worth; None if there are none."""
    findings, accepted = decision.findings, decision.accepted
    slack = min(rules.plain, rules.plain_share * (findings.none.mse - 1.0))
    near = [
        f
        for f in findings.fits
        if set(f.names) == set(accepted.names)
        and rival_in(f) is None
        and len(f.space.unknowns) <= len(accepted.space.unknowns)
        and f.mse <= accepted.mse + slack
        and findings.score(f) > findings.score(accepted) - rules.evidence
    ]
    return max(near, key=findings.score, default=None)


def _numbers_fall_short(decision: Decision) -> bool:
    return not effects_of(decision.accepted) and decision.accepted.mse > NUMBERS_LEAVE**2 * decision.floor
