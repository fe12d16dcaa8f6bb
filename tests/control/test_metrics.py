"""Scores: the floor, settling, limit cycles."""

from __future__ import annotations

import numpy as np
import pytest

from app.rivals import open_scenario
from control.compare import Job, run_job, summary
from control.design import DesignModel
from control.metrics import limit_cycle, score, score_hold
from control.scenarios import LADDER, SCENARIOS, Scenario, Segment, chosen_scenarios
from control.trial import Trace
from hal.errors import BadInput

VALVE = DesignModel()


@pytest.mark.thorough
def test_nobody_is_faster_than_the_floor() -> None:
    result = run_job(Job("brake", "ladder", 0, 0.1, VALVE), open_scenario)
    assert 1.0 <= result.score.ratio <= 1.2
    assert result.score.steady < 0.3


def test_settling_is_the_last_time_outside() -> None:
    error = np.full(400, 0.2)
    error[:31] = 0.21
    hold = score_hold(error, 0.2, (9.0, 0.1), 0.1, VALVE)
    assert hold.settling_s == pytest.approx(3.1)
    assert hold.overshoot == pytest.approx(100 * 0.01 / 0.5625)
    assert score_hold(np.full(400, 0.25), 0.2, (9.0, 0.1), 0.1, VALVE).settling_s is None


def test_limit_cycles_turn() -> None:
    t = np.arange(400) / 10.0
    assert limit_cycle(np.sin(t)) == pytest.approx(2.0, abs=0.02)
    assert limit_cycle(0.1 * np.sin(t)) == 0.0
    assert limit_cycle(np.exp(-t)) == 0.0


def test_ramps_and_holds_become_targets() -> None:
    scenario = Scenario("x", "", (Segment(0.1, 0.1, 1.0), Segment(0.1, 0.3, 2.0)))
    targets = scenario.targets(0.1)
    assert targets.size == 30
    assert targets[0] == 0.1
    assert targets[-1] == 0.3
    assert LADDER[4].end_in == pytest.approx(0.5625)


def test_unknown_scenarios_are_refused() -> None:
    assert len(chosen_scenarios(())) == len(SCENARIOS)
    with pytest.raises(BadInput, match="choose from ladder"):
        chosen_scenarios(("storm",))


def test_a_summary_takes_the_worst_and_the_median() -> None:
    results = [run_job(Job("if_then_line", "reversals", seed, 0.2, VALVE), open_scenario) for seed in (0, 1)]
    row = summary(results)["if_then_line"]
    assert row["steady_worst"] == max(r.score.steady for r in results)
    assert row["steady_spread"] == pytest.approx(abs(results[0].score.steady - results[1].score.steady))


def test_later_leaves_the_first_hold_out() -> None:
    """From a vented valve an If-Then rule is off in the first hold and on the target in the second."""
    held = Scenario("held", "two holds", (Segment(0.3, 0.3, 1.5), Segment(0.3, 0.3, 60.0)))
    targets = held.targets(0.1)
    stem = np.where(np.arange(targets.size) < 15, 0.25, 0.3)
    found = score(Trace(0.1 * np.arange(targets.size), targets, stem, stem, stem, stem), held, DesignModel())
    assert found.steady == pytest.approx(100.0 * 0.05 / 0.5625)
    assert found.later == pytest.approx(0.0, abs=1e-9)
