"""Closure against the floor, on residuals of known size."""

from __future__ import annotations

import numpy as np
import pytest

from twin.where.closure import closure, gap

N = 6000
FLOOR = 0.14


def noise(seed: int) -> np.ndarray:
    return FLOOR * np.random.default_rng(seed).standard_normal(N)


def slow(size: float) -> np.ndarray:
    return size * np.sqrt(2) * np.sin(np.arange(N) / 40.0)


def test_closure_of_known_residuals() -> None:
    share = closure(noise(1) + slow(4.0), noise(1) + slow(0.4), FLOOR, 3.0)
    assert share is not None
    assert share.value == pytest.approx(0.99, abs=0.002)
    assert share.ci95[0] <= 0.99 <= share.ci95[1]
    assert share.ci95[1] - share.ci95[0] < 0.01
    worse = closure(noise(1) + slow(1.0), noise(1) + slow(2.0), FLOOR)
    assert worse is not None
    assert worse.value == pytest.approx(-3.0, abs=0.1)


def test_nothing_to_close_is_none() -> None:
    assert closure(noise(1), noise(1), FLOOR) is None
    assert closure(np.full(N, np.nan), noise(1), FLOOR) is None


def test_a_model_a_little_below_a_floor_that_is_itself_measured_may_have_closed_all() -> None:
    before, after = noise(1) + slow(1.0), 0.97 * noise(1)
    sure, doubtful = (closure(before, after, FLOOR, floor_relative_error=e) for e in (0.0, 0.05))
    assert sure is not None
    assert doubtful is not None
    assert sure.value == doubtful.value > 1.0
    assert sure.ci95[0] > 1.0
    assert doubtful.ci95[0] < 1.0 < doubtful.ci95[1]


def test_missing_rows_are_left_out_of_both() -> None:
    before, after = noise(1) + slow(4.0), noise(1) + slow(0.4)
    before[::7], after[::5] = np.nan, np.nan
    share = closure(before, after, FLOOR)
    assert share is not None
    assert share.value == pytest.approx(0.99, abs=0.003)


def test_a_closed_share_is_that_of_the_errors_beside_it_and_is_there_whenever_they_are() -> None:
    before, after = noise(1) + slow(4.0), noise(1)
    before[:200] *= 3.0  # the worst rows, which nothing predicts
    after[:200] = np.nan
    found = gap(before, before, after, FLOOR, 100.0)
    assert found.reducible_closed is not None
    closed = 1.0 - (found.after**2 - found.noise_floor**2) / (found.before**2 - found.noise_floor**2)
    assert found.reducible_closed.value == pytest.approx(closed, abs=1e-9)
    quiet = np.where(np.arange(before.size) < 200, 50.0, noise(2) * 1e-3)  # nothing to close where both are known
    assert gap(quiet, quiet, after, FLOOR, 100.0).before < gap(quiet, quiet, after, FLOOR, 100.0).noise_floor


def test_gap_is_in_percent_of_travel_and_repeatable() -> None:
    arguments = (noise(1) + slow(4.0), noise(1) + slow(3.0), noise(1), FLOOR, 50.0)
    numbers = gap(*arguments)
    assert numbers == gap(*arguments)
    assert numbers.before == pytest.approx(2 * np.hypot(4.0, FLOOR), rel=0.01)
    assert numbers.noise_floor == pytest.approx(0.28)
    assert numbers.reducible_closed is not None
