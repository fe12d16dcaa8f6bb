"""Rivals from outside of the vocabulary that a plainer form inside it does without.

No machine is its design to the last percent: a regulator's wander looks like a zero that drifts by a trifle. Where the
same cause in a known form with fewer numbers leaves no more than a healthy machine might, and next to nothing of the
gap, what the rival does better speaks for no fault.
"""

from __future__ import annotations

from collections.abc import Sequence

from twin.fit.fitting import Fit
from twin.fit.space import Cause

#: Of the excess over the noise, what known causes may leave at the most without something from outside of the
#: vocabulary: they take over what they can of its part, and to explain the rest is no proof of them.
LEAVES = 0.05
#: Mean squared residual, noise = 1, that a healthy machine leaves (docs/calibration.md).
_HEALTHY = 1.3


def without_needless(fits: Sequence[Fit], none: Fit) -> list[Fit]:
    """`fits` without those from outside whose causes explain all but a trifle in a known form. `none`: no cause."""
    enough = min(_HEALTHY, 1.0 + LEAVES * max(none.mse - 1.0, 0.0))
    known = [f for f in fits if rival_in(f) is None and f.mse <= enough]
    return [f for f in fits if rival_in(f) is None or not any(_is_plainer(k, f) for k in known)]


def _is_plainer(known: Fit, rival: Fit) -> bool:
    """Whether a hypothesis of the same causes has fewer numbers."""
    return set(known.names) == set(rival.names) and len(known.space.unknowns) < len(rival.space.unknowns)


def rival_in(fit: Fit) -> Cause | None:
    """The cause of a hypothesis that lies outside of the vocabulary, if any."""
    return next((c for c in fit.space.causes if c.form is not None and c.form.outside), None)
