"""Noise and false readings before any model."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify_readings import false_readings, fast_noise

TIME_S = np.arange(0.0, 200.0, 0.1)
MOVING = np.clip(0.28 + 0.4 * np.sin(TIME_S / 4.0), 0.0, 0.56)  # up to 0.1 in/s, with stops


def test_noise_is_measured_under_motion_and_outliers() -> None:
    noisy = MOVING + 0.002 * np.random.default_rng(0).standard_normal(TIME_S.size)
    noisy[::50] = 3.0
    noisy[7] = np.nan
    assert fast_noise(noisy) == pytest.approx(0.002, rel=0.15)
    assert fast_noise(np.array([1.0])) == 0.0


def test_exactly_the_false_readings_are_found() -> None:
    values = MOVING + 0.0006 * np.random.default_rng(0).standard_normal(TIME_S.size)
    planted = np.zeros(TIME_S.size, dtype=bool)
    planted[[100, 101, 555, 900, 1500, 1999]] = True
    values[planted] = 2.0
    values[300] = np.nan
    assert np.array_equal(false_readings(values), planted)


def test_a_jump_that_stays_is_no_false_reading() -> None:
    values = np.where(TIME_S < 100.0, 0.1, 0.4) + 0.0006 * np.random.default_rng(0).standard_normal(TIME_S.size)
    assert not false_readings(values).any()
