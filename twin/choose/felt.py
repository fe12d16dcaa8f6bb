"""What is accepted, with nothing where the record says nothing."""

from __future__ import annotations

from dataclasses import replace

from twin.choose.decide import Decision
from twin.fit.unfelt import without_unfelt


def felt_only(decision: Decision) -> Decision:
    """The decision with its free curves at nothing where the signal never felt them."""
    accepted = decision.accepted
    plain = without_unfelt(decision.findings.channel, accepted, decision.findings.phi)
    if plain is accepted:
        return decision
    fits = tuple(plain if one is accepted else one for one in decision.findings.fits)
    findings = replace(decision.findings, fits=fits)
    return replace(decision, findings=findings, accepted=plain, rest=decision.rest_of(plain))
