"""A ghost goes where the valve goes, and looking ahead changes nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.oracle.ghost import Ghost
from app.rivals import open_scenario
from control.scenarios import SCENARIOS, holds


@pytest.mark.parametrize("name", ["dead_time", "stiction", "ep_hysteresis", "supply_droop", "lvdt_plus"])
def test_without_chance_it_is_the_valve(name: str) -> None:
    scenario = replace(SCENARIOS[name], noise=0.0, segments=holds((50.0,), 10.0))
    opened, ghost = open_scenario(scenario, 3), Ghost(scenario)
    assert opened.truth_in is not None
    commands = np.random.default_rng(1).uniform(3.0, 15.0, 30)
    opened.bench.exchange(float(commands[0]))
    for tick in range(1, 120):
        opened.clock.sleep_until(0.1 * tick)
        ghost.advance(float(commands[(tick - 1) // 4]), 0.1)
        seen = opened.bench.exchange(float(commands[tick // 4]))
        assert ghost.now("stem") == pytest.approx(opened.truth_in(), abs=1e-12)
        assert ghost.gain * ghost.now("stem") == pytest.approx(seen.position.value, abs=1e-12)


def test_it_looks_ahead_without_going_there() -> None:
    ghost = Ghost(SCENARIOS["ladder"])
    before = ghost.state.copy()
    assert ghost.lands_in([(11.0, 50)], 0.1) == pytest.approx(0.19 * (11.0 - 8.78), abs=1e-6)
    assert (ghost.state == before).all()
    ghost.put(0.1)
    assert ghost.lands_in([(11.0, 50)], 0.1) == pytest.approx(0.19 * (11.1 - 8.78), abs=1e-6)
