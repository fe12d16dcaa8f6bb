from __future__ import annotations

import numpy as np
import pytest

from app.interval import bootstrap, median, rate, share, wilson


def test_wilson_as_in_the_books() -> None:
    # Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert wilson(15, 148) == pytest.approx((0.0624, 0.1605), abs=1e-4)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-4)
    assert wilson(29, 29) == pytest.approx((0.8830, 1.0), abs=1e-4)


def test_a_share_reads_with_its_interval() -> None:
    assert share([True] * 81 + [False] * 182, 1) == "30.8 % (25.5 to 36.6 %)"
    assert share([True] * 20) == "100 % (84 to 100 %)"


def test_nothing_tried_is_nothing_known() -> None:
    assert wilson(0, 0) == (0.0, 1.0)
    assert rate([])["share"] is None
    assert median([])["median"] is None


def test_bootstrap_covers_the_median_of_a_known_population() -> None:
    chance = np.random.default_rng(3)
    inside = 0
    for _ in range(40):
        low, high = median(list(chance.exponential(1.0, 60)))["ci95"]
        inside += low <= np.log(2.0) <= high
    assert inside >= 34


def test_bootstrap_is_repeatable() -> None:
    values = [1.0, 2.0, 5.0, 9.0]
    assert bootstrap(values, np.mean) == bootstrap(values, np.mean)
