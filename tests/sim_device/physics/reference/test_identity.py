"""The healthy reference valve is a valve of the thesis's kind, and its physics is consistent."""

from __future__ import annotations

import time

import numpy as np
import pytest

from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from sim_device.physics.reference.plant import ReferenceValve
from sim_device.physics.reference.record import AREA, ATMOSPHERE, GAS, Build
from tests.sim_device.physics.excitation import Array, lively, slow_loop

TRAVEL = 0.5625


def branches() -> tuple[Array, Array]:
    """Slope [in/psi] and foot [psi] of the closing and the opening curve of a slow loop."""
    time_s, command = slow_loop(1800.0)
    pressure, position = record(make_physics("reference", noise=0.0), time_s, command)
    lines = []
    for rows in (command[1:] > command[:-1], command[1:] < command[:-1]):
        inside = np.flatnonzero(rows & (position[1:] > 0.1 * TRAVEL) & (position[1:] < 0.9 * TRAVEL)) + 1
        slope, start = np.polyfit(pressure[inside], position[inside], 1)
        lines.append((slope, -start / slope))
    return np.array(lines[0]), np.array(lines[1])


def test_its_curves_are_those_of_table_2_1() -> None:
    closing, opening = branches()
    assert [closing[0], opening[0]] == pytest.approx([0.19, 0.19], abs=0.004)
    assert closing[1] == pytest.approx(8.78, abs=0.08)
    assert opening[1] == pytest.approx(5.82, abs=0.08)


def step(before: float, after: float) -> tuple[Array, Array, Array]:
    time_s = np.arange(-60.0, 40.0, 0.05)
    pressure, position = record(make_physics("reference", noise=0.0), time_s, np.where(time_s <= 0.0, before, after))
    return time_s, pressure, position


def test_a_small_step_takes_the_time_constant_of_the_thesis() -> None:
    time_s, pressure, position = step(10.0, 10.25)
    rest = time_s > 0.0
    start, end = position[~rest][-1], position[-1]
    assert end - start == pytest.approx(0.19 * 0.25, rel=0.06)
    reached = time_s[np.argmax(position > start + 0.632 * (end - start))]
    assert reached == pytest.approx(2.7 + 0.3, abs=0.35)  # the valve's and the converter's
    assert time_s[np.argmax(pressure > 10.0 + 0.632 * 0.25)] == pytest.approx(0.3, abs=0.06)


def test_a_full_stroke_is_bounded_by_the_regulator() -> None:
    time_s, _, position = step(4.0, 13.5)
    start, end = (time_s[np.argmax(position > share * TRAVEL)] for share in (0.05, 0.4))
    assert 0.35 * TRAVEL / (end - start) == pytest.approx(0.12, abs=0.008)
    assert position[-1] == pytest.approx(TRAVEL, abs=0.0005)


def test_at_rest_all_balances() -> None:
    """Air, spring and friction add to zero; line and chamber are at one pressure; friction is within its bound."""
    valve = make_physics("reference", noise=0.0)
    assert isinstance(valve, ReferenceValve)
    build = Build()
    for hold_s, command in ((0.0, 4.0), (60.0, 11.0), (120.0, 9.0), (180.0, 7.0)):
        valve.advance(hold_s, command)
    valve.advance(300.0, 8.0)
    state = valve.state[0]
    assert state["line"] == pytest.approx(state["chamber"], abs=5.0)
    assert abs(state["v"]) < 1e-7
    area = AREA * (1.0 - build.area_loss * state["x"] / build.travel)
    net = state["chamber"] * area - build.preload - build.spring * state["x"]
    assert net == pytest.approx(build.bristle * state["bristle"], abs=1.0)
    assert abs(net) <= build.sliding * build.breakaway * 1.001


def test_the_air_that_went_in_is_in_the_chamber() -> None:
    """Filling a chamber whose stem is against its stop takes the mass that the gas law says, at constant temperature.

    The polytropic exponent is set to 1 for this, since heat that comes in later is not modelled.
    """
    valve = make_physics("reference", noise=0.0, polytropic=1.0, sliding=1.0e6)  # a stem that cannot move
    assert isinstance(valve, ReferenceValve)
    valve.advance(0.0, 3.0)
    taken = 0.0
    build = Build()
    from sim_device.physics.reference.air import flow

    for k in range(1, 40001):
        line, chamber = valve.state["line"][0] + ATMOSPHERE, valve.state["chamber"][0] + ATMOSPHERE
        valve.advance(k * 0.0005, 3.0)
        taken += 0.0005 * flow(build.tube, build.tube_b, build.tube_laminar, line, chamber)
    gained = valve.state["chamber"][0] * build.chamber_volume / GAS
    assert taken == pytest.approx(gained, rel=0.02)


def test_it_runs_far_faster_than_real_time() -> None:
    time_s, command = lively(300)
    valve = make_physics("reference")
    start = time.process_time()
    record(valve, time_s, command)
    assert time.process_time() - start < 1.5  # 200 times real time; measured 2500 on an idle core
