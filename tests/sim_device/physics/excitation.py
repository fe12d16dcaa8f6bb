"""Commands that the tests of the plants share; rows as in a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lively(seconds: int = 150, period_s: float = 0.1) -> tuple[Array, Array]:
    """Random steps of 2 to 9 s over the whole stroke, after one stroke to each end: times [s] and commands [psi]."""
    dice = np.random.default_rng(20)
    levels = [4.0, 13.5, 4.0, *dice.uniform(6.0, 12.5, seconds)]
    lengths = [20, 150, 120, *dice.integers(20, 90, seconds)]
    command = np.repeat(levels, lengths)[: int(seconds / period_s)]
    return np.arange(command.size) * period_s, command


def slow_loop(seconds: float = 1200.0, period_s: float = 0.2) -> tuple[Array, Array]:
    """From 4 to 13.5 psi and back in `seconds`, so slow that the valve is always at rest: times and commands."""
    time_s = np.arange(0.0, seconds, period_s)
    return time_s, np.interp(time_s, [0.0, seconds / 2, seconds], [4.0, 13.5, 4.0])
