"""The form of a converter's cause by the stem, where the pressure gauge cannot tell.

A dead zone and a play of the same width differ by less than a noisy gauge shows, and move the stem to different places
for good: the position has the better eye for it. Its cause stays what the pressure says, and so does its probability.
"""

from __future__ import annotations

from dataclasses import replace

from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.witness import driven_by_model, left_of_position
from twin.fit.case import Case
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.search.candidates import effect_causes

#: Mean squared error of the position, noise = 1, that leaves nothing to ask; and by how much less, and what share at
#: most, another form has to leave of it.
_FINE, _LESS, _SHARE = 1.1, 0.1, 0.9


def formed_by_stem(case: Case, converter: Decision, rules: DecisionRules) -> Decision:
    """The decision on the pressure with that form of its causes, among those that it cannot tell apart, whose pressure
    the stem followed best. As it was where the position has nothing to complain of."""
    if not converter.names:
        return converter
    least = _left(case, converter.accepted)
    best, limit = converter.accepted, min(_SHARE * least, least - _LESS)
    for other in _other_forms(case, converter, rules) if least > _FINE else ():
        if (left := _left(case, other)) < limit:
            best, limit = other, left
    if best is converter.accepted:
        return converter
    findings = replace(converter.findings, fits=(*converter.findings.fits, best))
    return replace(converter, findings=findings, accepted=best)


def _left(case: Case, one: Fit) -> float:
    return left_of_position(case, driven_by_model(one.plant, case.trials))


def _other_forms(case: Case, converter: Decision, rules: DecisionRules) -> list[Fit]:
    """The accepted causes with one of them in another form, as far as the pressure has nothing against it."""
    accepted, channel = converter.accepted, converter.findings.channel
    fits = []
    for other in effect_causes(channel, case.base):
        causes = [other if c.name == other.name else c for c in accepted.space.causes]
        if other.name in accepted.names and other.form not in [c.form for c in accepted.space.causes] and _known(other):
            space = make_space(case.base, causes, accepted.space.numbers, case.scales)
            fits.append(fit(channel, space, starts_of(space, [accepted], channel.recordings), refine=2))
    enough = converter.findings.score(accepted) - rules.evidence
    return [f for f in fits if converter.findings.score(f) > enough]


def _known(cause: Cause) -> bool:
    """Whether the form lies within the vocabulary."""
    return cause.form is not None and not cause.form.outside
