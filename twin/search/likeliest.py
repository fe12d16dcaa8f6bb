"""Hypotheses by how likely they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from twin.fit.fitting import Fit
from twin.search.claims import hollow
from twin.search.score import yardstick_for


def by_score(level: Sequence[Fit], use: np.ndarray) -> list[Fit]:
    """The hypotheses by their scores, best first: one that bends all numbers to imitate others is not likely.

    `use`: the rows that count.
    """
    return sorted(level, key=yardstick_for(level, use).score, reverse=True)


def likeliest(level: Sequence[Fit], use: np.ndarray) -> list[Fit]:
    """The same without those in which an effect has no size, if there are others.

    They take the credit for what their form does besides, and hide what else does it.
    """
    phi = yardstick_for(level, use).phi if level else 1.0
    return by_score([f for f in level if not hollow(f, phi)] or level, use)
