"""The accepted hypothesis with another cause, or another form of it, in the place of one."""

from __future__ import annotations

from collections.abc import Iterable

from twin.choose.decide import Decision
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space

_ROUNDS = 8


def in_place_of(decision: Decision, cause: Cause, others: Iterable[Cause]) -> list[Fit]:
    """What is accepted with each of the `others` in the place of `cause`, fitted from where it ended."""
    channel, accepted = decision.findings.channel, decision.accepted
    base, numbers, scales = accepted.space.base, accepted.space.numbers, accepted.space.scales
    fits = []
    for other in others:
        causes = [other if c is cause else c for c in accepted.space.causes]
        space = make_space(base, causes, numbers, scales)
        fits.append(fit(channel, space, starts_of(space, [accepted]), rounds=_ROUNDS))
    return fits
