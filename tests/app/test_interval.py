from __future__ import annotations

import numpy as np
import pytest

from app.interval import bootstrap, by_trial, median, median_by_trial, rate, share, wilson


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


@pytest.mark.thorough
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


def test_what_trials_hold_twice_is_no_surer_for_it() -> None:
    values = list(np.random.default_rng(4).exponential(1.0, 30))
    twice = [[value, value] for value in values]
    assert median_by_trial(twice)["ci95"] == median(values)["ci95"]
    assert by_trial(twice, np.mean) == pytest.approx(bootstrap(values, np.mean))
    wide, narrow = np.diff(by_trial(twice, np.mean)), np.diff(bootstrap(values * 2, np.mean))
    assert wide > 1.2 * narrow


def test_trials_may_hold_nothing() -> None:
    assert median_by_trial([[], []]) == median([]) == {"median": None, "of": 0, "ci95": None}
    found = median_by_trial([[], [1.0, 2.0], [3.0]])
    assert (found["median"], found["of"]) == (2.0, 3)
    assert 1.0 <= found["ci95"][0] <= 2.0 <= found["ci95"][1] <= 3.0
