"""The line through few points: its interval holds, and false points do not pull it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import t as student

from control.robust_line import Line, robust_line

SLOPE, START = 0.19, -1.67


def drawn(n: int, seed: int, false: int = 0) -> Line:
    chance = np.random.default_rng(seed)
    x = np.linspace(9.0, 11.0, n)
    y = START + SLOPE * x + 0.001 * chance.standard_normal(n)
    y[chance.choice(n, false, replace=False)] += 0.02
    return robust_line(x, y)


@pytest.mark.parametrize(("n", "false"), [(4, 0), (5, 0), (6, 0), (8, 0), (8, 1), (12, 0), (12, 2), (20, 1)])
def test_nineteen_in_twenty_intervals_hold_and_none_is_far_off(n: int, false: int) -> None:
    off = []
    for seed in range(300):
        line = drawn(n, seed, false)
        half = student.ppf(0.975, line.freedom) * np.sqrt(line.spread[1, 1])
        off.append(abs(line.slope - SLOPE) / half)
    assert 0.9 <= np.mean(np.array(off) < 1.0) <= 0.99
    assert np.mean(np.array(off) > 3.0) < 0.02


def test_false_points_count_for_nothing_from_eight_on() -> None:
    assert drawn(12, 1, false=2).used.sum() == 10
    assert drawn(12, 1, false=2).slope == pytest.approx(SLOPE, abs=0.002)
    assert drawn(6, 1).used.all()


def test_points_that_lie_on_the_line_leave_no_doubt() -> None:
    x = np.linspace(0.0, 1.0, 9)
    line = robust_line(x, 2.0 + 3.0 * x)
    assert (line.start, line.slope) == pytest.approx((2.0, 3.0))
    assert np.sqrt(line.spread[1, 1]) < 1e-9
