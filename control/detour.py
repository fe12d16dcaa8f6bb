"""A correction by way of the far edge, where the near one is hardly known.

The first move ends on one edge, which the dwell after it teaches to a few thousandths of a psi. The other one has only
been passed while the stem ran at its rate limit, which says little of where it is: a tenth of a psi is 3 % of travel.
To push by it is a guess that is larger than what is to be corrected, and pushes in vain make a filter of normal
distributions sure of a wrong edge. So the plate goes well beyond that edge and comes back by the one that is known.
"""

from __future__ import annotations

from control.play_filter import Belief

PASSED_PSI = 0.06  # an edge that has ended a move is known better than that, one that was only passed is not
BETTER = 2.0  # times as well as the near edge the far one has to be known
SURELY, BEYOND_PSI, MOST_PSI = 2.0, 0.05, 0.5  # so many deviations beyond the near edge, and so much, but no more
FURTHER = 1.25  # times that is aimed at, so that the pressure gets there within a tick or two
TIMES = 2  # per target; what is left then is pushed


def hardly_known(soon: Belief, miss_in: float) -> bool:
    """Whether the edge that pushes the way of a miss (+ closing) puts the plate somewhere to no better than that."""
    near_in, far_in = _doubts_in(soon, miss_in)
    return near_in > max(PASSED_PSI * soon.compliance, abs(miss_in), BETTER * far_in)


def gains(soon: Belief, miss_in: float) -> bool:
    """Whether coming back by the other edge leaves less than the miss."""
    return _doubts_in(soon, miss_in)[1] < abs(miss_in)


def over_psi(soon: Belief, miss_in: float) -> float:
    """How far the pressure has to go beyond the near edge, so that the plate surely comes along [psi]."""
    near_psi = _doubts_in(soon, miss_in)[0] / soon.compliance
    return min(BEYOND_PSI + SURELY * near_psi, MOST_PSI)


def _doubts_in(soon: Belief, miss_in: float) -> tuple[float, float]:
    side = 1 if miss_in > 0.0 else -1
    return soon.landing_doubt_in(side), soon.landing_doubt_in(-side)
