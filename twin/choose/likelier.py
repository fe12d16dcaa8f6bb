"""The likeliest causes in the place of those that were accepted for being plainer, and are not believed.

A wrong number is plainer than the effect that does a little better, and is accepted for it. Where the evidence is so
much for others that nobody believes the number, the gap is not unexplained: one of the others explains it.
"""

from __future__ import annotations

from dataclasses import replace

from twin.choose.decide import Decision
from twin.search.claims import hollow, size_of
from twin.search.needless import rival_in


def likelier(decision: Decision) -> Decision | None:
    """The decision for the likeliest hypothesis that is no larger, if that is another one, and explains the signal to
    its noise by causes that are known and have a size; None otherwise."""
    findings, accepted = decision.findings, decision.accepted
    fits = [f for f in findings.fits if 0 < size_of(f) <= size_of(accepted) and not hollow(f, findings.phi)]
    best = max(fits, key=findings.score, default=None)
    if best is None or best is accepted or not decision.explained or rival_in(best) is not None:
        return None
    other = replace(decision, accepted=best, rest=decision.rest_of(best))
    return other if other.exact else None
