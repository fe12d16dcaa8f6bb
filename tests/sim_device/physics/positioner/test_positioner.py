"""The three complaints of the thesis about the original positioner, which must emerge by themselves."""

from __future__ import annotations

import numpy as np
import pytest

from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from tests.sim_device.physics.excitation import Array

TRAVEL = 0.5625


def settled(percent: float, **options: object) -> Array:
    """The position in percent of travel during the last 120 s of a 240 s hold, coming from the open end."""
    time_s = np.arange(0.0, 240.0, 0.1)
    _, position = record(make_physics("positioner", noise=0.0, **options), time_s, np.full(time_s.size, percent))
    return 100.0 * position[1200:] / TRAVEL


def test_it_reaches_97_percent_of_travel() -> None:
    assert settled(100.0) == pytest.approx(97.0, abs=0.3)


def test_with_more_air_it_closes_so_that_the_supply_is_what_ends_it() -> None:
    assert settled(100.0, supply=13.0) == pytest.approx(100.0, abs=1.0)


def test_it_hunts_for_ever() -> None:
    position = settled(40.0)
    assert 4.0 < np.ptp(position) < 12.0
    crossings = np.count_nonzero(np.diff(np.sign(position - np.mean(position))))
    assert crossings >= 6


def test_its_mean_error_is_up_to_five_percent() -> None:
    errors = [abs(float(np.mean(settled(percent))) - percent) for percent in (10.0, 20.0, 40.0, 60.0, 80.0)]
    assert 3.5 < max(errors) < 5.5
    assert min(errors) < 2.0


def test_the_hunting_swings_the_pressure_across_the_deadband_of_the_valve() -> None:
    time_s = np.arange(0.0, 240.0, 0.1)
    pressure, _ = record(make_physics("positioner", noise=0.0), time_s, np.full(time_s.size, 40.0))
    assert np.ptp(pressure[1200:]) > 8.78 - 5.82


def test_faster_air_hunts_wider() -> None:
    assert np.ptp(settled(40.0, fill_tau=4.0, exhaust_tau=20.0)) > 1.2 * np.ptp(settled(40.0))


def test_a_pilot_with_a_wide_deadband_rests_off_target_instead() -> None:
    position = settled(40.0, opens=0.05, closes=0.045, leak=0.0)
    assert np.ptp(position) < 0.01
    assert abs(position[-1] - 40.0) > 3.0
