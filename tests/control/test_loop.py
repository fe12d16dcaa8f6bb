"""The loop on a toy bench: what is commanded, what is recorded, what ends it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from control.controller import make_controller
from control.design import DesignModel
from control.drive import ControllerDrive, OpenLoopDrive
from control.experiment_catalog import make_experiment
from control.loop import Hooks, Loop, Progress
from control.plan import Plan, plan_experiment, plan_targets
from control.step import Step
from hal.clock import SteppedClock
from hal.errors import SafetyTrip
from hal.sample import Quality, Reading, Sample
from tests.control.fakes import MISSING, Memory, ToyBench, lost
from tests.control.toy_valve import Toy, respond

SHORT = {"low": 8.0, "high": 10.0, "step": 1.0, "dwell_s": 2.0, "conditioning_s": 1.0}


def new(**options: object) -> tuple[ToyBench, SteppedClock, Memory]:
    clock = SteppedClock(50.0)
    return ToyBench(clock, **options), clock, Memory()  # type: ignore[arg-type]


def test_it_commands_exactly_what_the_experiment_announces() -> None:
    bench, clock, memory = new()
    experiment = make_experiment("staircase", SHORT)
    outcome = Loop(bench, clock, (memory,)).run(plan_experiment(experiment), OpenLoopDrive())
    schedule = experiment.commands()
    assert bench.commands == schedule.command.tolist()
    assert memory.column("step") == schedule.step.tolist()
    assert memory.column("time_s") == pytest.approx(schedule.time_s.tolist())
    assert (outcome.rows, outcome.steps_done, outcome.missing) == (schedule.command.size, 4, 0)


def test_a_row_pairs_its_readings_with_the_command_that_made_them() -> None:
    bench, clock, memory = new()
    Loop(bench, clock, (memory,)).run(plan_experiment(make_experiment("staircase", SHORT)), OpenLoopDrive())
    command, following = memory.column("command_psi"), memory.column("next_command_psi")
    assert command[0] == 0.0  # the safe command was in force before
    assert command[1:] == following[:-1]
    assert following == bench.commands
    pressure, position = respond(Toy(), np.array(memory.column("time_s")), np.array(command), step_s=0.02)
    assert memory.column("pressure_psi") == pytest.approx(pressure.tolist(), abs=1e-9)
    assert memory.column("position_in") == pytest.approx(position.tolist(), abs=1e-6)


def test_a_missing_reply_leaves_a_row_that_says_so() -> None:
    bench, clock, memory = new(before=lost({5, 6}))
    outcome = Loop(bench, clock, (memory,)).run(plan_experiment(make_experiment("staircase", SHORT)), OpenLoopDrive())
    assert outcome.missing == 2
    assert [i for i, q in enumerate(memory.column("quality")) if int(q) & MISSING] == [5, 6]
    assert math.isnan(memory.rows[5]["position_in"])
    assert outcome.rows == len(bench.commands) + 2
    assert any("no trusted reply" in text for _, _, text in memory.events)


@pytest.mark.parametrize(("count", "trips"), [(4, False), (5, True)])
def test_too_many_missing_replies_in_a_row_end_it(count: int, trips: bool) -> None:
    bench, clock, memory = new(before=lost(set(range(10, 10 + count))))
    loop = Loop(bench, clock, (memory,), max_missing=5)
    plan = plan_experiment(make_experiment("staircase", SHORT))
    if trips:
        with pytest.raises(SafetyTrip, match="in 5 ticks"):
            loop.run(plan, OpenLoopDrive())
    else:
        assert loop.run(plan, OpenLoopDrive()).missing == 4


def test_a_late_tick_keeps_the_experiment_in_time() -> None:
    bench, clock, memory = new()
    bench.before = lambda tick: clock.sleep_until(clock.now_s() + (0.25 if tick == 12 else 0.0))
    outcome = Loop(bench, clock, (memory,)).run(
        Plan(0.1, (Step(0.0, 10.0, rise_s=10.0), Step(10.0, 10.0, hold_s=1.0))), OpenLoopDrive()
    )
    assert outcome.overruns == 1
    time_s, command = np.array(memory.column("time_s")), np.array(bench.commands)
    ramp = (time_s < 9.9) & (np.arange(time_s.size) != 12) & (np.arange(time_s.size) != 13)
    assert command[ramp] == pytest.approx(time_s[ramp])  # 1 psi/s: the command is where its time says
    assert time_s[-1] == pytest.approx(10.9)
    assert max(memory.column("lateness_s")) == pytest.approx(0.15, abs=0.11)
    assert any("overrun" in text for _, _, text in memory.events)


def test_a_settled_stay_ends_early_and_an_unsettled_one_at_its_longest() -> None:
    bench, clock, memory = new()
    steps = (Step(9.5, 9.5, hold_s=60.0, until_settled=True), Step(10.0, 10.0, hold_s=3.0, until_settled=True))
    Loop(bench, clock, (memory,)).run(Plan(0.1, steps), OpenLoopDrive())
    stays = [memory.column("step").count(step) * 0.1 for step in (0.0, 1.0)]
    assert 8.0 < stays[0] < 30.0
    assert stays[1] == pytest.approx(3.0)


def test_the_closed_loop_replays_from_its_record() -> None:
    bench, clock, memory = new()
    controller = make_controller("pi_antiwindup", DesignModel())
    plan = plan_targets([0.2, 0.1], 20.0, 0.1, 0.5625)
    Loop(bench, clock, (memory,)).run(plan, ControllerDrive(controller, 0.1, 0.0))
    assert bench.commands[0] == 0.0
    state = None
    for row, following in zip(memory.rows, memory.rows[1:], strict=False):
        t = row["time_s"]
        sample = Sample(
            t, row["next_command_psi"], Reading(row["position_in"], t, 0.0), Reading(row["pressure_psi"], t, 0.0)
        )
        if state is None:
            state = controller.initial(sample, row["target_in"])
        state, command = controller.step(state, sample, row["target_in"], 0.1)
        assert command == following["next_command_psi"]
    assert set(memory.column("target_in")) == {0.2, 0.1}


def test_notes_progress_and_states_reach_their_sinks() -> None:
    bench, clock, memory = new()
    seen: list[Progress] = []
    texts = [[], ["the fan is loud"]]
    hooks = Hooks(progress=seen.append, notes=lambda: texts.pop(0) if texts else ())
    plan = plan_experiment(make_experiment("staircase", SHORT))
    Loop(bench, clock, (memory,), hooks).run(plan, OpenLoopDrive())
    assert memory.notes == [(pytest.approx(0.1), "the fan is loud")]
    assert [text for _, text in memory.states] == ["conditioning", "running"]
    assert [p.done_s for p in seen] == sorted(p.done_s for p in seen)
    assert seen[-1].done_s == pytest.approx(plan.duration_s)


def test_a_stop_is_looked_for_between_two_ticks_only() -> None:
    bench, clock, memory = new()

    def check() -> None:
        if len(memory.rows) == 7:
            raise KeyboardInterrupt

    loop = Loop(bench, clock, (memory,), Hooks(check=check))
    with pytest.raises(KeyboardInterrupt):
        loop.run(plan_experiment(make_experiment("staircase", SHORT)), OpenLoopDrive())
    assert len(memory.rows) == len(bench.commands) == 7


def test_only_declared_further_channels_are_recorded() -> None:
    class WithAux(ToyBench):
        def exchange(self, command_psi: float) -> Sample:
            s = super().exchange(command_psi)
            aux = {"supply_psi": Reading(20.0, s.time_s, 0.0), "watchdog_status": Reading(0.0, s.time_s, 0.0)}
            return Sample(s.time_s, s.commanded_psi, s.position, s.pressure, aux=aux)

    clock, memory = SteppedClock(), Memory()
    Loop(WithAux(clock), clock, (memory,), aux=("supply_psi",)).run(
        Plan(0.1, (Step(1.0, 1.0, 0.0, 1.0),)), OpenLoopDrive()
    )
    assert memory.rows[0]["supply_psi"] == 20.0
    assert "watchdog_status" not in memory.rows[0]


def test_a_bench_that_hands_out_missing_samples_is_left_to_count_them_itself() -> None:
    class Lossy(ToyBench):
        def exchange(self, command_psi: float) -> Sample:
            s = super().exchange(command_psi)
            return Sample(s.time_s, s.commanded_psi, Reading(math.nan, s.time_s, 0.0, Quality.MISSING))

    clock, memory = SteppedClock(), Memory()
    outcome = Loop(Lossy(clock), clock, (memory,)).run(Plan(0.1, (Step(1.0, 1.0, 0.0, 5.0),)), OpenLoopDrive())
    assert outcome.missing == 50
