"""Causes that these very records cannot tell apart, though others could."""

from __future__ import annotations

from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.fit.fitting import Fit


def alike(decision: Decision, name: str) -> tuple[str, ...]:
    """Causes that could stand in the place of an accepted one, and whose predictions the noise hides from its own.

    A stop that is not where it should be looks like a wrong zero where the other stop is never reached. Between such
    causes neither may be likely, while one of them is sure. Only of what is explained to its noise: what a hypothesis
    leaves beyond it, another may leave as well. Shape of the answer: names, the likeliest first, without `name`.
    """
    if not decision.exact or name not in decision.names:
        return ()
    others = set(decision.names) - {name}
    near = [f for f in decision.findings.fits if _in_place(f, others, name) and hidden(decision, f)]
    near = sorted(near, key=decision.findings.score, reverse=True)
    return tuple(dict.fromkeys(next(iter(set(f.names) - others)) for f in near))


def hidden(decision: Decision, fit: Fit) -> bool:
    """Whether the noise hides what `fit` predicts otherwise than the accepted hypothesis.

    If one of them were true, its log-likelihood would exceed the other's by less, in the mean, than a cause has to be
    worth: half the squared difference of their residuals, noise = 1.
    """
    apart = fit.residuals - decision.accepted.residuals
    return 0.5 * float(apart @ apart) / decision.findings.phi < DecisionRules().evidence


def _in_place(fit: Fit, others: set[str], name: str) -> bool:
    """Whether a hypothesis is the accepted one with another single effect in the place of `name`."""
    new = set(fit.names) - others
    return len(fit.names) == len(others) + 1 and others < set(fit.names) and new != {name}
