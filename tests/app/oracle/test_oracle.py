"""The oracle on single trials: within the goal, inside the range of commands, also where the plate sticks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.oracle.oracle import Oracle
from app.rivals import open_scenario
from control.compare import true_valve
from control.metrics import GOAL_PERCENT, hold_scores
from control.scenarios import SCENARIOS, holds
from control.trial import run_trial


@pytest.mark.parametrize("name", ["noise", "stiction", "dead_time", "lvdt_minus", "ep_hysteresis"])
def test_a_known_valve_ends_where_it_should(name: str) -> None:
    scenario = replace(SCENARIOS[name], segments=holds((30.0, 33.0, 31.0, 96.0, 0.0), 40.0))
    trace = run_trial(open_scenario(scenario, 5), Oracle(scenario), scenario.targets(0.1), 0.1)
    assert np.all((trace.command_psi >= 0.0) & (trace.command_psi <= 20.0))
    found = hold_scores(trace, scenario, true_valve(scenario))
    assert max(hold.steady for hold in found) < GOAL_PERCENT
    assert not any(hold.cycle for hold in found)
