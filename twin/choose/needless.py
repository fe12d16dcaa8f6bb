"""Rivals from outside of the vocabulary that a plainer form inside it does without.

No machine is its design to the last percent: a regulator's wander looks like a zero that drifts by a trifle. Where the
same cause in a known form with fewer numbers leaves no more than a healthy machine might, and next to nothing of the
gap, what the rival does better speaks for no fault.
"""

from __future__ import annotations

from collections.abc import Sequence

from twin.fit.fitting import Fit

#: Of the excess over the noise, what known causes may leave at the most without something from outside of the
#: vocabulary: they take over what they can of its part, and to explain the rest is no proof of them.
LEAVES = 0.05
#: Mean squared residual, noise = 1, that a healthy machine leaves (docs/calibration.md).
_HEALTHY = 1.3


def without_needless(fits: Sequence[Fit], none: Fit) -> list[Fit]:
    """`fits` without those from outside whose causes explain all but a trifle in a known form. `none`: no cause."""
    enough = min(_HEALTHY, 1.0 + LEAVES * max(none.mse - 1.0, 0.0))
    known = [f for f in fits if not _outside(f) and f.mse <= enough]
    plain: dict[tuple[str, ...], int] = {}
    for f in known:
        plain[_claim(f)] = min(plain.get(_claim(f), _numbers(f)), _numbers(f))
    return [f for f in fits if not (_outside(f) and plain.get(_claim(f), _numbers(f)) < _numbers(f))]


def _claim(fit: Fit) -> tuple[str, ...]:
    return tuple(sorted(fit.names))


def _numbers(fit: Fit) -> int:
    return len(fit.space.unknowns)


def _outside(fit: Fit) -> bool:
    return any(c.form is not None and c.form.outside for c in fit.space.causes)
