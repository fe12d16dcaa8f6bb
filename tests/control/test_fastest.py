"""The physical minimum of a step, against hand-made bounds and against every other way of switching."""

from __future__ import annotations

import math

import numpy as np
import pytest

from control.design import DesignModel
from control.fastest import STEP_S, Supply, fastest_s
from control.observer import follow

VALVE, SUPPLY = DesignModel(), Supply()
BAND_IN = 0.005 * VALVE.travel


def test_no_way_to_go_takes_no_time() -> None:
    assert fastest_s(VALVE, SUPPLY, (8.0, 0.2), 0.2 + BAND_IN, BAND_IN) == 0.0


def test_a_long_way_takes_the_rate_limit_and_little_more() -> None:
    least_s = fastest_s(VALVE, SUPPLY, (10.0, 0.05), 0.25, BAND_IN)
    assert 0.197 / 0.12 < least_s < 0.197 / 0.12 + 0.4


@pytest.mark.parametrize("far", [0.01, 0.02, 0.05, 0.2])
def test_crossing_the_deadband_costs(far: float) -> None:
    start, target = 0.25, 0.25 + far * VALVE.travel
    on_edge = VALVE.a1 + start / VALVE.compliance
    near = fastest_s(VALVE, SUPPLY, (on_edge, start), target, BAND_IN)
    across = fastest_s(VALVE, SUPPLY, (on_edge - VALVE.deadband, start), target, BAND_IN)
    # the lag needs that long for the deadband with 20 psi of supply
    lag_s = VALVE.ep_tau_s * math.log((20.0 - on_edge + VALVE.deadband) / (20.0 - on_edge))
    assert across - near == pytest.approx(lag_s, abs=3 * STEP_S)


def test_dead_time_and_supply_count() -> None:
    start = (9.5, 0.2)
    free = fastest_s(VALVE, SUPPLY, start, 0.4, BAND_IN)
    assert fastest_s(VALVE, Supply(dead_time_s=0.2), start, 0.4, BAND_IN) == pytest.approx(free + 0.2)
    assert fastest_s(VALVE, Supply(ceiling_psi=11.0), start, 0.4, BAND_IN) > free + 0.5
    assert fastest_s(VALVE, Supply(full_psi=9.0), start, 0.4, BAND_IN) == math.inf


@pytest.mark.parametrize(
    "far", [pytest.param(0.02, marks=pytest.mark.thorough), pytest.param(0.08, marks=pytest.mark.thorough), 0.3]
)
def test_no_sequence_of_random_commands_beats_it(far: float) -> None:
    """Bang-bang with one switch is the optimum: a thousand random piecewise constant commands settle later."""
    rng, start, target = np.random.default_rng(3), (10.2, 0.2), 0.2 + far * VALVE.travel
    least_s = fastest_s(VALVE, SUPPLY, start, target, BAND_IN)
    for _ in range(300):
        assert settles_s(rng.choice([0.0, 6.0, 8.0, 10.5, 12.0, 20.0], 8), start, target) >= least_s - 0.02


def settles_s(commands: np.ndarray, start: tuple[float, float], target: float) -> float:
    """When the stem is inside for good, with each command held for 0.15 s and the last one for 30 s."""
    (p, x), w, t, last, h = start, start[1], 0.0, 0.0, 0.01
    for index, command in enumerate(commands):
        for _ in range(3000 if index == len(commands) - 1 else 15):
            p += (command - p) * (1.0 - math.exp(-h / VALVE.ep_tau_s))
            k = VALVE.compliance
            w = min(max(k * (p - VALVE.a1), min(k * (p - VALVE.a2), w), 0.0), VALVE.travel)
            x, t = follow(x, w, VALVE.tau_s, VALVE.rate_limit, h), t + h
            last = t if abs(x - target) > BAND_IN else last
    return last
