"""What comes before the first step, and what a bench refuses before anything moves."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.experiment_catalog import make_experiment
from control.plan import check_bench, plan_experiment, plan_targets
from hal.clock import SteppedClock
from hal.errors import BadInput
from tests.control.fakes import ToyBench

STAIRS = make_experiment("staircase", {"low": 4.0, "high": 13.0, "step": 3.0})


def test_a_sweep_begins_with_a_full_stroke() -> None:
    plan = plan_experiment(STAIRS)
    assert [step.end for step in plan.lead] == [4.0, 13.0, 4.0]
    assert [step.end for step in plan.steps] == [7.0, 10.0, 13.0, 10.0, 7.0, 4.0]
    assert plan.duration_s == STAIRS.duration_s


def test_without_conditioning_it_begins_at_once() -> None:
    assert plan_experiment(replace(STAIRS, conditioning=False)).lead == ()


def test_what_is_left_is_reached_by_a_stroke_and_the_turning_points() -> None:
    plan = plan_experiment(replace(STAIRS, conditioning=False), first=4)
    assert [step.end for step in plan.lead] == [4.0, 13.0, 4.0, 13.0, 10.0]
    assert [step.end for step in plan.steps] == [7.0, 4.0]
    assert plan.first == 4


def test_a_multisine_is_gone_on_with_after_a_whole_period() -> None:
    plan = plan_experiment(make_experiment("multisine", {"periods": 3}), first=2)
    assert plan.lead[-1] == plan.steps[0]


def test_there_must_be_such_a_step() -> None:
    with pytest.raises(BadInput, match="steps 0 to 5, there is no step 6"):
        plan_experiment(STAIRS, first=6)


@pytest.mark.parametrize(
    ("targets", "hold_s", "words"),
    [([], 10.0, "no target"), ([0.1, 0.6], 10.0, "target 2 is 0.6 in"), ([0.1], 0.0, "above 0"), ([-0.1], 1.0, "-0.1")],
)
def test_targets_must_lie_in_the_travel(targets: list[float], hold_s: float, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        plan_targets(targets, hold_s, 0.1, 0.5625)


def test_the_ends_of_the_travel_are_targets_too() -> None:
    assert [step.end for step in plan_targets([0.0, 0.5625], 5.0, 0.1, 0.5625).steps] == [0.0, 0.5625]


def test_a_bench_refuses_what_it_cannot_do() -> None:
    info = ToyBench(SteppedClock(), min_period_s=0.05).info
    plan = plan_experiment(STAIRS)
    check_bench(plan, "psi", 4.0, 13.0, info)
    with pytest.raises(BadInput, match="takes psi"):
        check_bench(plan, "percent", 0.0, 100.0, info)
    with pytest.raises(BadInput, match=r"commands 4 to 21 psi, bench 'toy' allows 0 to 20 psi"):
        check_bench(plan, "psi", 4.0, 21.0, info)
    with pytest.raises(BadInput, match=r"needs 0\.05 s for a tick"):
        check_bench(replace(plan, period_s=0.04), "psi", 4.0, 13.0, info)
