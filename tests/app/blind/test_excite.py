from __future__ import annotations

import numpy as np

from app.blind.excite import PERIOD_S, TRAVEL_IN, closed_loop, commands, open_loop
from control.experiments.random import RandomSteps
from control.plan import plan_experiment


def test_the_sequence_is_gone_through_twice_alike() -> None:
    plan = open_loop(3)
    half = len(plan.steps) // 2
    assert plan.steps[:half] == plan.steps[half:]
    assert 700.0 < plan.duration_s < 1000.0


def test_seeds_differ_in_the_random_part_only() -> None:
    one, other = open_loop(3), open_loop(4)
    differing = sum(a != b for a, b in zip(one.steps, other.steps, strict=True))
    assert differing == 2 * 12


def test_commands_are_those_of_a_record() -> None:
    experiment = RandomSteps(seed=5, count=6)
    plan = plan_experiment(experiment)
    sent = experiment.commands().command
    time_s, command = commands(plan)
    assert command[0] == 0.0
    np.testing.assert_array_equal(command[1:], sent[:-1])
    np.testing.assert_allclose(np.diff(time_s), PERIOD_S)


def test_closed_loop_targets_are_inside_the_travel() -> None:
    targets = [step.end for step in closed_loop(9).steps]
    assert len(targets) == 6 and min(targets) > 0.04 and max(targets) < TRAVEL_IN - 0.04
    assert targets != [step.end for step in closed_loop(10).steps]
