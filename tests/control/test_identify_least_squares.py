"""The small robust least-squares solver."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify_least_squares import Problem, minimise, soft_cost
from logs.recording import FloatArray

T = np.linspace(0.0, 5.0, 400)


def problem(data: FloatArray, low: float = 0.0, high: float = 10.0, soft: float = 0.1) -> Problem:
    def residual(v: FloatArray) -> FloatArray:
        return np.asarray(data - v[0] * np.exp(-T / v[1]))

    return Problem(residual, np.array([low, 0.05]), np.array([high, 20.0]), np.array([1e-5, 1e-5]), soft)


def test_it_finds_a_decay_from_far_away() -> None:
    found, cost = minimise(problem(3.0 * np.exp(-T / 1.3)), np.array([0.5, 8.0]), rounds=60)
    assert found == pytest.approx([3.0, 1.3], rel=1e-4)
    assert cost < 1e-6


def test_false_readings_hardly_pull() -> None:
    data = 3.0 * np.exp(-T / 1.3) + 0.01 * np.random.default_rng(1).standard_normal(T.size)
    data[::20] += 30.0
    found, _ = minimise(problem(data, soft=0.03), np.array([2.0, 2.0]), rounds=60)
    assert found == pytest.approx([3.0, 1.3], rel=0.01)


def test_a_bound_is_kept_and_the_rest_still_fitted() -> None:
    found, _ = minimise(problem(3.0 * np.exp(-T / 1.3), high=2.0), np.array([1.0, 1.0]), rounds=60)
    assert found[0] == 2.0
    assert found[1] > 1.3


def test_a_number_without_effect_stays_where_it_is() -> None:
    data = np.full(50, 4.0)
    flat = Problem(lambda v: data - v[0], np.array([0.0, 0.0]), np.array([9.0, 9.0]), np.full(2, 1e-5), 1.0)
    found, _ = minimise(flat, np.array([1.0, 5.0]), rounds=10)
    assert found == pytest.approx([4.0, 5.0], rel=1e-5)


def test_the_cost_is_square_for_small_and_linear_for_large_residuals() -> None:
    assert soft_cost(np.array([0.01]), 1.0) == pytest.approx(1e-4, rel=1e-3)
    assert soft_cost(np.array([1000.0]), 1.0) == pytest.approx(2000.0, rel=2e-3)
