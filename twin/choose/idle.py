"""Effects that explain no more than re-tuning does, and spare the design numbers nothing by it."""

from __future__ import annotations

from twin.fit.channel import Channel
from twin.fit.fitting import Fit
from twin.search.findings import Findings

#: Share of the squared moves of the design numbers in re-tuning that an idle effect does not spare them.
_SPARED = 0.5
#: What a move of a design number changes at least in all squared residuals, noise = 1, if the signal feels it.
_FELT = 1.0


def idle(findings: Findings, fit: Fit, slack: float) -> bool:
    """Whether the effects of `fit` are: re-tuning leaves at most `slack` of the noise variance more."""
    retuned = findings.retuned
    return retuned.mse <= fit.mse + slack and _moved(findings, fit) >= _SPARED * _moved(findings, retuned)


def _moved(findings: Findings, fit: Fit) -> float:
    """How far the design numbers moved: relative to themselves, squared.

    Those count that the signal feels: a rate limit that is never met may go anywhere.
    """
    moves = enumerate(fit.z[: len(fit.space.numbers)])
    return sum(float(z * z) for k, z in moves if z and _feels(findings.channel, fit, k))


def _feels(channel: Channel, fit: Fit, k: int) -> bool:
    """Whether it would change the signal to leave a number as it was designed."""
    as_designed = fit.z.copy()
    as_designed[k] = 0.0
    change = channel.residuals(fit.space.plant(as_designed)) - channel.residuals(fit.plant)
    return float(change @ change) > _FELT
