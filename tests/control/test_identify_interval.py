"""Intervals that hold when residuals hang together."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify_interval import Interval, covariance, intervals, memory_rows


def coloured(n: int, memory: float, seed: int) -> np.ndarray:
    chance = np.random.default_rng(seed).standard_normal(n)
    out = np.zeros(n)
    keep = np.exp(-1.0 / memory)
    for i in range(1, n):
        out[i] = keep * out[i - 1] + np.sqrt(1.0 - keep**2) * chance[i]
    return out


@pytest.mark.parametrize("memory", [0.1, 20.0])
def test_nineteen_in_twenty_intervals_hold_the_truth(memory: float) -> None:
    n, hits = 3000, 0
    x = np.sin(np.arange(n) / 150.0)
    design = np.column_stack((x, np.ones(n)))
    for seed in range(60):
        data = 2.0 * x + 1.0 + coloured(n, memory, seed)
        found = np.linalg.lstsq(design, data, rcond=None)[0]
        hits += intervals(found, design, data - design @ found)[0].holds(2.0)
    assert 51 <= hits <= 60


def test_memory_of_white_and_coloured_noise() -> None:
    assert memory_rows(np.random.default_rng(0).standard_normal(5000)) < 1.6
    assert memory_rows(coloured(20_000, 20.0, 1)) == pytest.approx(40.0, rel=0.4)


def test_a_parameter_that_changes_nothing_is_unknown() -> None:
    slopes = np.column_stack((np.ones(100), np.zeros(100)))
    spread, _ = covariance(slopes, np.random.default_rng(0).standard_normal(100))
    assert np.isfinite(spread[0, 0])
    assert np.isinf(spread[1, 1])


def test_an_interval_knows_what_it_holds() -> None:
    interval = Interval(1.0, 0.5, 1.5)
    assert interval.half_width == 0.5
    assert interval.holds(0.5)
    assert not interval.holds(1.6)
