from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.blind.calibration import calibration, curve, error, honest


def test_honest_claims_have_no_error() -> None:
    claims = [(0.75, True)] * 30 + [(0.75, False)] * 10
    assert error(claims) == pytest.approx(0.0)


def test_boasting_shows() -> None:
    claims = [(0.99, True)] * 50 + [(0.99, False)] * 50
    found = calibration([[claim] for claim in claims])
    assert found["ece"] == pytest.approx(0.49)
    low, high = found["ci95"]
    assert 0.35 < low < 0.49 < high < 0.62
    assert found["brier"] == pytest.approx(0.5 * 0.01**2 + 0.5 * 0.99**2)


def test_errors_in_both_directions_do_not_cancel() -> None:
    claims = [(0.95, False)] * 10 + [(0.2, True)] * 10
    assert error(claims) == pytest.approx(0.5 * 0.95 + 0.5 * 0.8)


def test_every_probability_has_a_bin() -> None:
    claims = [(p, True) for p in (0.0, 0.3, 0.95, 1.0)]
    assert sum(point["claims"] for point in curve(claims)) == 4


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), min_size=1, max_size=60))
def test_the_error_is_that_of_the_curve(claims: list[tuple[float, bool]]) -> None:
    by_bins = sum(point["claims"] * abs(point["said"] - point["right"]) for point in curve(claims))
    assert error(claims) == pytest.approx(by_bins / len(claims), abs=1e-12)


def test_no_claims_is_no_figure() -> None:
    assert calibration([[], []])["ece"] is None
    assert np.isnan(error([]))


def test_few_honest_claims_have_an_error_by_chance() -> None:
    """Sixteen claims of 0.9: the mean distance of a binomial share from 0.9 is 0.0598, by its distribution."""
    found = honest([(0.9, k < 14) for k in range(16)])
    assert found["mean"] == pytest.approx(0.0598, abs=0.004)
    # 14 of 16 is 0.025 away; nothing is nearer, and only 14 is as near
    assert found["above"] == pytest.approx(1.0, abs=1e-9)
    # 13 of 16 is 0.0875 away; 14 and 15 are nearer
    nearer = 120 * 0.9**14 * 0.1**2 + 16 * 0.9**15 * 0.1
    assert honest([(0.9, k < 13) for k in range(16)])["above"] == pytest.approx(1.0 - nearer, abs=0.04)


def test_boasting_is_not_by_chance() -> None:
    assert honest([(0.9, k < 40) for k in range(80)])["above"] == 0.0


@pytest.mark.thorough
def test_honesty_is_found_out_with_more_claims() -> None:
    few, many = ([(0.8, k < 0.8 * n) for k in range(n)] for n in (20, 500))
    assert honest(few)["mean"] > 3.0 * honest(many)["mean"]
    low, high = honest(many)["range95"]
    assert low < honest(many)["mean"] < high
