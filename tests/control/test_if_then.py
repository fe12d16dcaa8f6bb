"""The If-Then rule: equations (3-1) and (3-3), and figure 3-5's two steps."""

from __future__ import annotations

import pytest

from app.physics_bench import open_virtual
from control.controller import make_controller
from control.design import DesignModel
from control.if_then import Decision, crossing_psi, threshold_line_psi
from hal.sample import Reading, Sample

DESIGN = DesignModel()


@pytest.mark.parametrize(
    ("error", "pressure", "crossing"),
    [(0.1, 7.0, 2.96), (0.1, 9.0, 0.0), (-0.1, 9.0, -2.96), (-0.1, 7.0, 0.0), (0.0, 7.0, 0.0)],
)
def test_the_deadband_is_added_on_the_wrong_side_only(error: float, pressure: float, crossing: float) -> None:
    assert crossing_psi(error, pressure, 8.12, 2.96) == crossing


def test_the_printed_3_3_is_the_line_midway_between_the_curves() -> None:
    for x in (0.0, 0.2, 0.5625):
        closing, opening = DESIGN.a1 + x / DESIGN.compliance, DESIGN.a2 + x / DESIGN.compliance
        midway = threshold_line_psi(x, DESIGN.compliance, DESIGN.a1, DESIGN.a2)
        assert midway == pytest.approx(0.5 * (closing + opening))


@pytest.mark.parametrize(("pressure", "step"), [(9.833, 0.1 / 0.19), (6.873, 0.1 / 0.19 + 2.96)])
def test_the_two_steps_of_figure_3_5(pressure: float, step: float) -> None:
    controller = make_controller("if_then_line", DESIGN)
    at_rest = Sample(0.0, pressure, Reading(0.2, 0.0, 0.0), Reading(pressure, 0.0, 0.0))
    _, command = controller.step(controller.initial(at_rest, 0.3), at_rest, 0.3, 0.1)
    assert command == pytest.approx(pressure + step)


@pytest.mark.parametrize("name", ["if_then_constant", "if_then_line", "if_then_pi"])
@pytest.mark.parametrize("rest_psi", [7.6, 8.6, 9.9])
def test_taking_over_a_valve_at_rest_inside_the_deadband_does_not_move_it(name: str, rest_psi: float) -> None:
    """On the virtual valve, with the noise of its readings; it came up the closing curve and was let off to rest."""
    for seed in range(2):
        opened, tick = open_virtual(seed), 0
        assert opened.truth_in is not None
        sample = opened.bench.exchange(5.0)
        for command_psi, ticks in ((5.0, 100), (DESIGN.a1 + 0.25 / DESIGN.compliance, 400), (rest_psi, 100)):
            for _ in range(ticks):
                tick += 1
                opened.clock.sleep_until(0.1 * tick)
                sample = opened.bench.exchange(command_psi)
        controller, stems = make_controller(name, DESIGN), [opened.truth_in()]
        state = controller.initial(sample, 0.25)
        for _ in range(600):
            tick += 1
            state, command_psi = controller.step(state, sample, 0.25, 0.1)
            opened.clock.sleep_until(0.1 * tick)
            sample = opened.bench.exchange(command_psi)
            stems.append(opened.truth_in())
        assert max(stems) - min(stems) < 0.01 * DESIGN.travel


@pytest.mark.parametrize("name", ["if_then_line", "if_then_pi"])
def test_the_first_move_after_a_hand_over_ends_on_the_curve(name: str) -> None:
    """Half a deadband off it, equation (3-1) alone would add a whole one."""
    between = Sample(0.0, 7.9, Reading(0.2, 0.0, 0.0), Reading(7.9, 0.0, 0.0))
    controller = make_controller(name, DESIGN, ki=0.0) if name == "if_then_pi" else make_controller(name, DESIGN)
    _, command = controller.step(controller.initial(between, 0.2), between, 0.25, 0.1)
    assert command == pytest.approx(DESIGN.a1 + 0.25 / DESIGN.compliance)


def test_only_the_target_of_the_hand_over_forgives_noise() -> None:
    resting = Decision(0.0, 9.0, rests_in=0.2)
    assert resting.left_alone(0.2, -0.0017, 0.0) and not resting.left_alone(0.2, 0.0019, 0.0)
    assert not resting.left_alone(0.21, 0.0001, 0.0) and not Decision(0.0, 9.0).left_alone(0.2, 0.0001, 0.0)
    assert resting.left_alone(0.21, 0.003, 0.003)


def test_it_decides_at_its_own_pace() -> None:
    decision = Decision(0.3, 9.0)
    ticks = 0
    while not decision.due(0.1):
        decision, ticks = decision.later(0.1), ticks + 1
    assert ticks == 3
