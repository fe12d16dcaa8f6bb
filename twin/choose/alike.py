"""Causes that these very records cannot tell apart, though others could."""

from __future__ import annotations

import numpy as np

from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.fit.fitting import Fit

#: Of the squares that are left without a cause, what its hypothesis may leave, and another predict otherwise, at the
#: most, where more than the noise is left.
_HARDLY = 0.004


def alike(decision: Decision, name: str) -> tuple[str, ...]:
    """Causes that could stand in the place of an accepted one, and whose predictions the noise hides from its own.

    A stop that is not where it should be looks like a wrong zero where the other stop is never reached. Between such
    causes neither may be likely, while one of them is sure. Only of what is explained to its noise: what a hypothesis
    leaves beyond it, another may leave as well. But where several leave a sixteenth of a large gap, and the same
    sixteenth or another, that gap is what each of them does, be the rest whose it may. Shape of the answer: names,
    the likeliest first, without `name`.
    """
    if name not in decision.names:
        return ()
    others = set(decision.names) - {name}
    slack = _slack(decision, others)
    near = [f for f in decision.findings.fits if _in_place(f, others, name)]
    near = [f for f in near if (decision.exact and hidden(decision, f)) or _apart(decision, f) < slack]
    near = sorted(near, key=decision.findings.score, reverse=True)
    return tuple(dict.fromkeys(next(iter(set(f.names) - others)) for f in near))


def hidden(decision: Decision, fit: Fit) -> bool:
    """Whether the noise hides what `fit` predicts otherwise than the accepted hypothesis.

    If one of them were true, its log-likelihood would exceed the other's by less, in the mean, than a cause has to be
    worth: half the squared difference of their residuals, noise = 1.
    """
    apart = fit.residuals - decision.accepted.residuals
    return 0.5 * float(apart @ apart) / decision.findings.phi < DecisionRules().evidence


def _slack(decision: Decision, others: set[str]) -> float:
    """How far apart predictions may be that do the same, as a mean square, noise = 1; 0 where too much is left."""
    fits = [f for f in decision.findings.fits if set(f.names) == others] if others else [decision.findings.none]
    gap = min((f.mse for f in fits), default=0.0) - decision.floor
    return _HARDLY * gap if decision.accepted.mse - decision.floor < _HARDLY * gap else 0.0


def _apart(decision: Decision, fit: Fit) -> float:
    """Mean square of what `fit` predicts otherwise than the accepted hypothesis, noise = 1."""
    return float(np.mean((fit.residuals - decision.accepted.residuals) ** 2))


def _in_place(fit: Fit, others: set[str], name: str) -> bool:
    """Whether a hypothesis is the accepted one with another single effect in the place of `name`."""
    new = set(fit.names) - others
    return len(fit.names) == len(others) + 1 and others < set(fit.names) and new != {name}
