"""Plain arithmetic against the libraries that it replaces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from control.exact import considered, decay, dot, lag, length, times, triangle

CHANCE = np.random.default_rng(5)


def covariance(size: int, rank: int) -> np.ndarray:
    wide = CHANCE.normal(size=(size, rank)) * 10.0 ** CHANCE.uniform(-4, 1, size)[:, None]
    return np.asarray(wide @ wide.T)


@pytest.mark.parametrize("u", [0.0, 1e-9, 0.011, 0.0625, 0.33, 1.0, 5.0, 40.0])
def test_decay_is_the_exponential(u: float) -> None:
    assert decay(u) == pytest.approx(math.exp(-u), rel=1e-14 * max(u, 1.0), abs=0.0)


def test_a_lag_goes_all_the_way_in_no_time_constant_and_none_in_no_time() -> None:
    assert lag(0.1, 0.0) == 1.0
    assert lag(0.0, 0.3) == 0.0
    assert decay(math.inf) == 0.0


def test_length() -> None:
    assert length(3.0, 4.0) == 5.0


@pytest.mark.parametrize("rank", [7, 5, 1])
def test_the_triangle_gives_the_covariance_back(rank: int) -> None:
    cov = covariance(7, rank)
    root = np.array(triangle(cov.tolist()))
    scale = np.sqrt(np.outer(np.diag(cov), np.diag(cov)))
    assert np.abs((root @ root.T - cov) / scale).max() < 1e-5 * (rank < 7) + 1e-11
    assert not np.triu(root, 1).any()


@pytest.mark.parametrize("learns", [7, 4, 0])
def test_what_is_learned_is_josephs_form(learns: int) -> None:
    mean, cov, h = CHANCE.normal(size=7), covariance(7, 7), np.zeros(7)
    h[[3, 4, 6]] = 1.0, -0.19, 2.2
    row = ((3, 1.0), (4, -0.19), (6, 2.2))
    gain = cov @ h / (h @ cov @ h + 0.01)
    gain[learns:] = 0.0
    keep = np.eye(7) - np.outer(gain, h)
    learned, after = considered(mean.tolist(), cov.tolist(), row, 0.3, 0.01, learns)
    assert learned == pytest.approx(mean + 0.3 * gain)
    assert np.array(after) == pytest.approx(keep @ cov @ keep.T + 0.01 * np.outer(gain, gain), abs=1e-12)
    assert times(cov.tolist(), row) == pytest.approx(cov @ h)
    assert dot(row, mean.tolist()) == pytest.approx(h @ mean)
