"""Whether readings that stand out are false, or the noise has a heavy tail.

A tail thins out: of the readings that come back from far beyond their neighbours it leaves most not much farther than
where they begin to be called false, and more that come near that. False readings lie anywhere.
Source: Embrechts, Klueppelberg, Mikosch, Modelling Extremal Events (Springer 1997), ch. 6 (Pareto tails).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import binom

from logs.recording import FloatArray

#: Share of what a reading has to stand out by to be called false, from which it is near that. Gaussian noise is not.
NEAR = 2.0 / 3.0
#: The heaviest tail of a noise: far out its readings thin out with this power of the distance. Student's noise of
#: four degrees of freedom has 4.
_POWER = 3.0
#: How unlikely a tail may make what was counted.
_UNLIKELY = 0.01


@dataclass(frozen=True, slots=True)
class Tail:
    """Readings away from both neighbours: how many stand out by `NEAR` of what false ones do or more, and how far those
    of them do that are called false, 1 = just so far (`excess`, shape (k,))."""

    near: int
    excess: FloatArray

    @property
    def heavy(self) -> bool:
        """Whether a heavy tail makes so many, and so large ones."""
        far = self.excess.size
        if far == 0:
            return False
        few = float(binom.sf(far - 1, self.near, NEAR**_POWER)) > _UNLIKELY
        # logarithms of Pareto's excesses are exponential, with a mean of 1 / power
        return bool(few and np.log(self.excess).mean() < (1.0 + 2.0 / np.sqrt(far)) / _POWER)


def together(tails: Sequence[Tail]) -> Tail:
    """What several recordings show."""
    return Tail(sum(t.near for t in tails), np.concatenate([t.excess for t in tails]))
