"""The bounds: against averaged readings of the virtual gauge, and every scenario within the goal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.physics_bench import open_virtual
from control.compare import true_valve
from control.fastest import Supply
from control.permitted import least_error_percent, reaches
from control.scenarios import SCENARIOS, TRAVEL_IN, Scenario, holds


@pytest.mark.parametrize("noise", [1.0, 4.0])
def test_the_gauge_is_as_good_as_its_averaged_readings(noise: float) -> None:
    means = []
    for seed in range(60):
        opened = open_virtual(seed, noise=noise)
        readings = []
        for tick in range(100):
            opened.clock.sleep_until(0.1 * tick)
            readings.append(opened.bench.exchange(0.0).position.value)
        means.append(np.mean(readings))
    seen = 200.0 * float(np.std(means)) / TRAVEL_IN
    said = least_error_percent(Scenario("x", "", holds((50.0,), 40.0), noise=noise), 10.0, 0.1)
    assert said == pytest.approx(seen, rel=0.3)


@pytest.mark.parametrize("name", SCENARIOS)
def test_gauge_and_supply_of_every_scenario_permit_the_goal(name: str) -> None:
    scenario = SCENARIOS[name]
    assert least_error_percent(scenario, 10.0, 0.1) < 0.3
    assert reaches(scenario, true_valve(scenario))


def test_a_supply_that_is_too_low_does_not() -> None:
    scenario = replace(SCENARIOS["ladder"], effects={"supply_saturation/droop": 4.0})
    assert scenario.supply != Supply()
    assert not reaches(scenario, true_valve(scenario))
