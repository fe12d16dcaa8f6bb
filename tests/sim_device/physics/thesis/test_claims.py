"""Imperfections of the thesis plant do what their claims say, in numbers."""

from __future__ import annotations

import numpy as np
import pytest

from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from tests.sim_device.physics.excitation import Array, lively, slow_loop

K, A1, A2, TRAVEL = 0.19, 8.78, 5.82, 0.5625


def play(time_s: Array, command: Array, **effects: float) -> tuple[Array, Array]:
    keys = {name.replace("__", "/"): size for name, size in effects.items()}
    return record(make_physics("thesis", 5, noise=0.0, effects=keys), time_s, command)


def curves(**effects: float) -> tuple[Array, Array]:
    """Pressure where the stem passes 20 %, 50 % and 80 % of travel, closing and opening [psi]."""
    time_s, command = slow_loop()
    pressure, position = play(time_s, command, **effects)
    half = time_s.size // 2
    marks = np.array([0.2, 0.5, 0.8]) * TRAVEL
    closing = np.interp(marks, position[:half], pressure[:half])
    opening = np.interp(marks, position[half:][::-1], pressure[half:][::-1])
    return closing, opening


def test_healthy_curves_are_those_of_table_2_1() -> None:
    closing, opening = curves()
    marks = np.array([0.2, 0.5, 0.8]) * TRAVEL
    assert closing == pytest.approx(A1 + marks / K, abs=0.06)  # the ramp's own lag is 0.05 psi
    assert opening == pytest.approx(A2 + marks / K, abs=0.06)


def test_dead_time_moves_the_pressure_and_nothing_else() -> None:
    time_s, command = lively(60)
    healthy, late = play(time_s, command), play(time_s, command, dead_time=0.7)
    assert np.allclose(late[0][7:], healthy[0][:-7], atol=1e-3)
    assert np.allclose(late[1][7:], healthy[1][:-7], atol=1e-4)


@pytest.mark.parametrize(("form", "error"), [("zero", [0.3, 0.3]), ("span", [0.3 * 1 / 12, 0.3 * 10 / 12])])
def test_calibration_of_the_converter(form: str, error: list[float]) -> None:
    time_s = np.arange(0.0, 20.0, 0.1)
    command = np.where(time_s < 10.0, 4.0, 13.0)
    pressure, _ = play(time_s, command, **{f"ep_calibration__{form}": 0.3})
    assert [pressure[95] - 4.0, pressure[-1] - 13.0] == pytest.approx(error, abs=1e-6)


def test_the_deadband_of_the_converter_swallows_small_changes() -> None:
    time_s = np.arange(0.0, 40.0, 0.1)
    command = np.where(time_s < 20.0, 9.0, 9.3)
    assert play(time_s, command, ep_deadband=0.35)[0][-1] == pytest.approx(9.0, abs=1e-6)
    assert play(time_s, command, ep_deadband=0.25)[0][-1] == pytest.approx(9.3, abs=1e-6)


def test_the_rate_limit_of_the_converter_is_a_slope() -> None:
    time_s = np.arange(0.0, 30.0, 0.1)
    command = np.where(time_s < 10.0, 5.0, 12.0)
    pressure, _ = play(time_s, command, ep_rate_limit=2.0)
    assert np.max(np.diff(pressure)) == pytest.approx(0.05, rel=1e-6)


def test_the_supply_is_a_ceiling() -> None:
    time_s, command = lively(60)
    assert np.max(play(time_s, command, supply_saturation=4.0)[0]) == pytest.approx(11.0, abs=1e-9)


def test_stiction_needs_breakaway_after_a_rest_and_then_jumps() -> None:
    time_s = np.arange(0.0, 400.0, 0.1)
    command = np.interp(time_s, [0.0, 30.0, 90.0, 400.0], [10.0, 10.0, 10.0, 11.55])
    healthy, sticky = play(time_s, command)[1], play(time_s, command, stiction=0.4)[1]
    moved = [float(time_s[np.argmax(x > x[800] + 0.004)]) for x in (healthy, sticky)]
    assert moved[1] - moved[0] == pytest.approx(0.4 / 0.005, rel=0.15)  # psi over psi/s
    assert np.max(np.diff(sticky)) > 5.0 * np.max(np.diff(healthy[800:]))


def test_asymmetric_spring_turns_the_two_curves_apart() -> None:
    closing, opening = curves(spring_asymmetry=0.2)
    stroke = 0.6 * TRAVEL
    assert stroke / (closing[2] - closing[0]) == pytest.approx(1.1 * K, rel=0.01)
    assert stroke / (opening[2] - opening[0]) == pytest.approx(0.9 * K, rel=0.01)


def test_friction_at_one_place_widens_the_loop_there() -> None:
    healthy, spot = (np.subtract(*curves(**effects)) for effects in ({}, {"position_dependent_friction": 0.3}))
    wider = spot - healthy
    assert np.max(wider) > 0.2
    assert np.min(wider) < 0.5 * np.max(wider)


def test_friction_that_drifts_is_not_there_at_first() -> None:
    first, second = (np.mean(np.subtract(*curves(**effects))) for effects in ({}, {"friction_drift": 0.5}))
    assert 0.6 < second - first < 1.0  # twice 0.5 psi, reached by and by in these 20 min


def test_friction_in_motion_stops_the_stem_when_the_pressure_turns() -> None:
    time_s = np.arange(0.0, 20.0, 0.1)
    command = np.where(time_s < 4.0, 11.5, 9.5)
    coasting, stopping = play(time_s, command)[1], play(time_s, command, friction_in_motion=1.0)[1]
    assert coasting[-1] - coasting[45] > 0.1
    assert stopping[-1] - stopping[45] < 0.01


def test_soft_friction_lets_inner_reversals_move_the_stem() -> None:
    time_s = np.arange(0.0, 240.0, 0.1)
    command = np.interp(time_s, [0.0, 100.0, 240.0], [4.0, 11.0, 11.0 - 2.4])
    rigid, soft = play(time_s, command)[1], play(time_s, command, distributed_hysteresis=1.3)[1]
    assert rigid[1200] - rigid[-1] < 0.002
    assert soft[1200] - soft[-1] > 0.02


def test_creep_arrives_late_and_arrives() -> None:
    time_s = np.arange(0.0, 900.0, 0.1)
    position = play(time_s, np.full(time_s.size, 11.0), creep=0.2)[1]
    goal = K * (11.0 - A1)
    assert position[200] < 0.93 * goal
    assert position[-1] == pytest.approx(goal, rel=0.002)


@pytest.mark.parametrize(("form", "low", "high"), [("closed", 0.0, TRAVEL - 0.08), ("open", 0.08, TRAVEL)])
def test_stops(form: str, low: float, high: float) -> None:
    time_s, command = lively(60)
    position = play(time_s, command, **{f"reduced_travel__{form}": 0.08})[1]
    assert np.min(position[50:]) == pytest.approx(low, abs=3e-3)
    assert np.max(position) == pytest.approx(high, abs=3e-3)


def test_lost_motion_is_the_width_of_the_loop_between_stem_and_reading() -> None:
    time_s, command = slow_loop()
    stem, seen = play(time_s, command)[1], play(time_s, command, linkage_lost_motion=0.03)[1]
    error = seen - stem
    assert np.ptp(error) == pytest.approx(0.03, rel=0.02)


def test_a_slow_daq_repeats_itself() -> None:
    time_s, command = lively(60)
    position = play(time_s, command, stale_samples=0.5)[1]
    assert np.mean(np.diff(position[20:150]) == 0.0) == pytest.approx(0.8, abs=0.05)


def test_quantization_is_a_grid() -> None:
    time_s, command = lively(60)
    steps = play(time_s, command, sensor_quantization=0.015)[1] / 0.015
    assert np.allclose(steps, np.round(steps))
    assert len(np.unique(np.round(steps))) > 20


def test_dropouts_come_in_the_share_they_should() -> None:
    time_s = np.arange(0.0, 300.0, 0.1)
    position = play(time_s, np.full(time_s.size, 11.0), sensor_dropouts=0.03)[1]
    assert np.mean(position[200:] == 0.0) == pytest.approx(0.03, abs=0.01)
