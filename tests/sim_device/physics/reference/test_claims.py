"""Faults of the reference valve do to the signals what their names say."""

from __future__ import annotations

import numpy as np
import pytest

from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from tests.sim_device.physics.excitation import Array, lively

TRAVEL = 0.5625


def play(time_s: Array, command: Array, **effects: float) -> tuple[Array, Array]:
    return record(make_physics("reference", 5, noise=0.0, effects=effects), time_s, command)


def held(*levels: float, seconds: int = 40) -> tuple[Array, Array]:
    command = np.repeat(levels, seconds * 10)
    return np.arange(command.size) * 0.1, command


def test_the_stem_stops_when_the_pressure_turns() -> None:
    """The friction is inside the balance of forces, so there is no coasting to a target of the past."""
    time_s = np.arange(0.0, 20.0, 0.1)
    position = play(time_s, np.where(time_s < 4.0, 11.5, 9.5))[1]
    assert 0.05 < position[45] < 0.4
    assert abs(position[-1] - position[50]) < 0.005


def test_a_blocked_exhaust_slows_the_fall_and_not_the_rise() -> None:
    time_s, command = held(5.0, 12.0, 5.0)

    def half_life(pressure: Array, row: int, goal: float) -> float:
        part = np.abs(pressure[row:] - goal)
        return float(np.argmax(part < 0.5 * part[0])) * 0.1

    healthy, dirty = play(time_s, command)[0], play(time_s, command, fill_exhaust_asymmetry=20.0)[0]
    assert half_life(dirty, 400, 12.0) == pytest.approx(half_life(healthy, 400, 12.0), abs=0.11)
    assert half_life(dirty, 800, 5.0) > 3.0 * half_life(healthy, 800, 5.0)


def test_the_pressure_stays_below_its_supply() -> None:
    time_s, command = held(4.0, 14.0)
    assert np.max(play(time_s, command, supply_saturation=9.0)[0]) == pytest.approx(11.0, abs=0.05)


def test_overlapping_ports_leave_the_pressure_where_it_is() -> None:
    time_s, command = held(11.0, 10.0, 10.5, 10.1)
    pressure = play(time_s, command, ep_deadband=0.6)[0]
    assert pressure[[390, 790]] == pytest.approx([10.7, 10.3], abs=0.02)
    assert np.ptp(pressure[790:]) < 0.01
    assert np.ptp(play(time_s, command)[0][790:]) == pytest.approx(0.5, abs=0.02)


def test_dry_packing_sticks_and_slips_on_a_slow_ramp() -> None:
    time_s = np.arange(0.0, 300.0, 0.1)
    command = np.interp(time_s, [0.0, 300.0], [8.5, 13.0])

    def unevenness(stiction: float) -> float:
        speed = np.diff(play(time_s, command, stiction=stiction)[1])[1200:2000]
        return float(np.std(speed) / np.mean(speed))

    assert unevenness(0.0) < 0.15
    assert unevenness(0.9) > 0.8


def test_a_torn_diaphragm_moves_the_stem_at_the_same_pressure_reading() -> None:
    time_s, command = held(4.0, 11.5, seconds=60)
    healthy, torn = play(time_s, command), play(time_s, command, diaphragm_hole=3.0)
    assert np.max(np.abs(healthy[1][-200:] - torn[1][-200:])) > 0.005
    assert np.max(np.abs(healthy[0][-200:] - torn[0][-200:])) < 0.2


def test_a_tight_regulator_bounds_the_speed() -> None:
    time_s, command = held(4.0, 13.5)
    speeds = [
        float(np.max(np.diff(play(time_s, command, **effects)[1]))) / 0.1
        for effects in ({}, {"parameter:rate_limit": 0.5})
    ]
    assert speeds[1] == pytest.approx(0.5 * speeds[0], rel=0.1)


def test_a_long_refresh_repeats_readings_and_interference_flips_bits() -> None:
    time_s, command = lively(60)
    stale = play(time_s, command, stale_samples=0.5)[1]
    assert np.mean(np.diff(stale[20:140]) == 0.0) == pytest.approx(0.8, abs=0.07)
    healthy, hit = play(time_s, command)[1], play(time_s, command, sensor_dropouts=0.1)[1]
    jumps = np.abs(hit - healthy)[np.abs(hit - healthy) > 1e-9]
    assert {round(float(jump), 6) for jump in jumps} == {0.5, 0.25, 0.125}
    assert jumps.size / time_s.size == pytest.approx(0.1, abs=0.04)
