"""The healthy thesis plant against its design equations, integrated here with scipy."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from tests.sim_device.physics.excitation import Array, lively

K, A1, A2, TAU, RATE, EP_TAU, TRAVEL = 0.19, 8.78, 5.82, 2.7, 0.12, 0.30, 0.5625


def by_the_book(time_s: Array, command: Array) -> tuple[Array, Array]:
    """Pressure and position by an adaptive solver; the pressure is monotone within a row, so the play is exact."""
    p, w, x = 0.0, 0.0, 0.0
    rows = [(p, x)]
    for (start, end), u in zip(pairwise(time_s), command[1:], strict=True):

        def pressure(t: float, p0: float = p, u: float = u, t0: float = start) -> float:
            return u + (p0 - u) * np.exp(-(t - t0) / EP_TAU)

        def plate(t: float, w0: float = w) -> float:
            p_now = pressure(t)
            return min(max(K * (p_now - A1), min(K * (p_now - A2), w0), 0.0), TRAVEL)

        def speed(t: float, y: Array) -> list[float]:
            return [min(max((plate(t) - y[0]) / TAU, -RATE), RATE)]

        solved = solve_ivp(speed, (start, end), [x], rtol=1e-8, atol=1e-10, max_step=0.05)
        x = min(max(float(solved.y[0, -1]), 0.0), TRAVEL)
        p, w = pressure(end), plate(end)
        rows.append((p, x))
    pressure_psi, position_in = np.array(rows).T
    return pressure_psi, position_in


@pytest.mark.parametrize("period_s", [0.1, 0.5])
def test_the_healthy_plant_is_the_design_to_a_twentieth_of_a_percent_of_travel(period_s: float) -> None:
    time_s, command = lively(90, period_s)
    expected = by_the_book(time_s, command)
    seen = record(make_physics("thesis", noise=0.0), time_s, command)
    assert np.max(np.abs(seen[0] - expected[0])) < 1e-6
    assert np.max(np.abs(seen[1] - expected[1])) < 0.0005 * TRAVEL
    assert np.ptp(seen[1]) == pytest.approx(TRAVEL, abs=2e-4)  # the excitation used the whole stroke


def test_other_design_numbers_are_used() -> None:
    time_s = np.arange(0.0, 60.0, 0.1)
    valve = make_physics("thesis", noise=0.0, a1=9.5, compliance=0.1, travel=0.4)
    _, position = record(valve, time_s, np.full(time_s.size, 11.0))
    assert position[-1] == pytest.approx(0.1 * (11.0 - 9.5), abs=1e-6)


def test_the_readings_have_the_noise_they_should_have() -> None:
    time_s = np.arange(0.0, 400.0, 0.1)
    command = np.where(time_s < 30.0, 11.5, 10.0)  # down into the deadband, where the pilot's unrest moves no stem
    pressure, position = record(make_physics("thesis", 3), time_s, command)
    still = time_s > 60.0
    assert np.std(position[still]) == pytest.approx(0.0006, rel=0.15)
    assert np.std(np.diff(pressure[still])) / np.sqrt(2.0) == pytest.approx(0.0038, rel=0.1)
    twice = record(make_physics("thesis", 3, noise=2.0), time_s, command)[1]
    assert np.std(twice[still]) == pytest.approx(2.0 * np.std(position[still]), rel=0.05)


def test_twenty_minutes_at_10_hz_take_no_time() -> None:
    time_s, command = lively(1200)
    valve = make_physics("thesis", effects={"creep": 0.1, "stiction": 0.2, "flow_force": 0.1, "stale_samples": 0.4})
    start = time.process_time()
    record(valve, time_s, command)
    assert time.process_time() - start < 0.6  # 2000 times real time; measured 8000 to 12000 on an idle core
