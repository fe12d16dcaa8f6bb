"""The points through the play, against chance: many draws through the same play."""

from __future__ import annotations

import numpy as np
import pytest

from control.observer import follow
from control.play_points import W, X, moved

SDS = (6e-4, 1e-3, 2e-3, 2e-4, 0.02, 0.02, 5e-4)


@pytest.mark.parametrize(("p", "w"), [(8.0, 0.25), (10.5, 0.25), (6.5, 0.25), (10.1, 0.249)])
def test_means_and_spreads_are_those_of_many_draws(p: float, w: float) -> None:
    """Inside the gap, pushed either way and just at the edge; the play bends what is normal there."""
    mean, pressures = [0.25, 0.12, 0.5625, w, 8.78, 5.82, 0.19], [p, p + 0.01, p + 0.02]
    draws = np.random.default_rng(1).normal(mean, SDS, (4000, 7))
    after = np.array([through(draw, pressures) for draw in draws])
    cov = np.diag(np.square(SDS)).tolist()
    found = moved(mean, cov, pressures, 2.7, 0.033)
    spread = np.sqrt([cov[X][X], cov[W][W]])
    assert np.abs(np.array(found) - after.mean(axis=0)).max() < 0.15 * spread.max()
    assert spread == pytest.approx(after.std(axis=0), rel=0.2)


def through(draw: np.ndarray, pressures: list[float]) -> tuple[float, float]:
    x, rate, travel, w, a1, a2, k = (float(value) for value in draw)
    for p in pressures:
        before, w = w, min(max(k * (p - a1), min(k * (p - a2), w), 0.0), travel)
        x = follow(x, 0.5 * (before + w), 2.7, rate, 0.033)
    return x, w
