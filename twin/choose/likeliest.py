"""Hypotheses by how likely they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from twin.choose.claims import hollow
from twin.choose.score import yardstick_for
from twin.fit.fitting import Fit


def likeliest(level: Sequence[Fit], use: np.ndarray) -> list[Fit]:
    """The hypotheses by their scores, best first: one that bends all numbers to imitate others is not likely.

    Without those in which an effect has no size, if there are others: they take the credit for what their form does
    besides, and hide what else does it. `use`: the rows that count.
    """
    yardstick = yardstick_for(level, use)
    sized = [f for f in level if not hollow(f, yardstick.phi)] or level
    return sorted(sized, key=yardstick.score, reverse=True)
