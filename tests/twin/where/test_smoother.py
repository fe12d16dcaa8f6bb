"""The smoothed pressure: what is left of the noise by its memory, next to edges, and between two rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.trials import DESIGN, trial_of
from twin.fit.smooth import smoothed_pressure
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.noise.robust import remembered
from twin.where.smoother import LONGEST_S, WHITE, mean_variances, smooth_pressure

DT = 0.1


def wandering(n: int, memory: float, seed: int, whites: int = 1) -> np.ndarray:
    """Noise of variance 1, of first order with correlation `memory` from row to row, in `whites` rows of it."""
    dice = np.random.default_rng(seed).normal(size=(whites, n))
    out = dice.copy()
    for k in range(1, n):
        out[:, k] = memory * out[:, k - 1] + np.sqrt(1.0 - memory**2) * dice[:, k]
    return out


def test_a_filter_remembers_what_it_was_fitted_to() -> None:
    assert remembered((), 3) == pytest.approx([1.0, 0.0, 0.0])
    assert remembered((0.9,), 50) == pytest.approx(0.9 ** np.arange(50), abs=1e-3)
    second = remembered((0.5, 0.3), 40)
    assert second[1] == pytest.approx(0.5 / 0.7)  # Yule and Walker
    assert second[2] == pytest.approx(0.5 * second[1] + 0.3)


@pytest.mark.parametrize("spacing", [1.0, 2.0])
def test_the_variance_of_a_mean_is_that_of_means(spacing: float) -> None:
    noise = wandering(24, 0.8, 3, 40_000)[:, :: int(spacing)]
    said = mean_variances(remembered((0.8,), 100), 12, spacing)
    assert said[0] == np.inf and said[1] == 1.0
    for count in (2, 5, 12):
        assert said[count] == pytest.approx(np.var(noise[:, :count].mean(axis=1)), rel=0.03)
    assert mean_variances(WHITE, 8)[1:] == pytest.approx(1.0 / np.arange(1, 9))


def test_behind_an_edge_as_little_noise_is_left_as_elsewhere() -> None:
    """A bell that has an edge within it is none; the rows behind one have all that follows it."""
    misses, told = [], []
    for seed in range(200):
        step = np.where(np.arange(200) < 100, 0.0, 0.5)
        read = step + 0.01 * np.random.default_rng(seed).normal(size=200)
        smooth, variance = smooth_pressure(read, np.zeros(200), 0.01, DT)
        misses.append((smooth - step)[[99, 100, 40]])
        told.append(variance[[99, 100, 40]])
    left = np.sqrt(np.mean(np.square(misses), axis=0)) / 0.01
    assert left[2] < 0.2 and np.all(left[:2] < 0.35)
    assert np.sqrt(np.median(told, axis=0)) / 0.01 == pytest.approx([0.17, 0.17, 0.12], abs=0.04)


def test_what_wanders_slowly_is_followed_and_a_memory_is_counted() -> None:
    slow = 0.01 * wandering(3000, 0.99, 1)[0]
    white = 0.01 * np.random.default_rng(2).normal(size=3000)
    correlation = np.append(1.0, 0.5 * 0.99 ** np.arange(1, 200))
    smooth, variance = smooth_pressure(slow + white, np.zeros(3000), 0.01 * np.sqrt(2.0), DT, correlation)
    assert np.std(smooth - slow) < 0.45 * 0.01
    _, forgetful = smooth_pressure(slow + white, np.zeros(3000), 0.01 * np.sqrt(2.0), DT)
    assert np.median(variance) > 4.0 * np.median(forgetful)


def test_missing_readings_are_bridged_and_none_at_all_is_the_model() -> None:
    read, model = np.full(200, np.nan), np.linspace(5.0, 6.0, 200)
    smooth, variance = smooth_pressure(read, model, 0.01, DT)
    assert np.array_equal(smooth, model) and np.all(np.isinf(variance))
    read[::2] = model[::2] + 0.2
    read[80:150] = np.nan  # longer than any average
    smooth, variance = smooth_pressure(read, model, 0.01, DT)
    assert smooth == pytest.approx(model + 0.2)
    assert np.isinf(variance[115]) and np.isfinite(variance[81]) and LONGEST_S < 7.0


def test_a_model_that_arrives_late_leaves_no_peak_between_two_rows() -> None:
    """What it lacks on the way up is not added to where it has arrived: a play would keep the peak."""
    weak = Inserted("supply_saturation", effect("supply_saturation").form("cut_off"), (10.0,))
    trial, _ = trial_of(Plant(replace(DESIGN, ep_tau_s=0.25), (weak,)), np.tile(np.repeat([6.0, 13.0], 100), 5))
    driven = smoothed_pressure(Plant(replace(DESIGN, ep_tau_s=0.30), (weak,)), trial, 0.004)
    assert trial.recording.pressure is not None and trial.recording.pressure.max() == pytest.approx(10.0)
    assert driven.max() < 10.001  # 0.016 psi more, or half a percent of travel, for less than a row
