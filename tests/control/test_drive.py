"""From planned values to commands."""

from __future__ import annotations

import math

from control.controller import make_controller
from control.design import DesignModel
from control.drive import ControllerDrive, OpenLoopDrive
from hal.sample import Reading, Sample


def sample(position_in: float, commanded: float) -> Sample:
    return Sample(0.0, commanded, Reading(position_in, 0.0, 0.0), Reading(commanded, 0.0, 0.0))


def test_in_an_open_loop_the_plan_is_the_command() -> None:
    drive = OpenLoopDrive()
    assert drive.command(9.5) == 9.5
    drive.saw(sample(0.1, 9.5), 9.5)
    assert math.isnan(drive.target_in(9.5))


def test_a_controller_begins_from_the_command_in_force_and_then_answers_each_sample() -> None:
    controller = make_controller("pi", DesignModel())
    drive = ControllerDrive(controller, 0.1, 7.5)
    assert drive.command(0.2) == 7.5
    drive.saw(sample(0.0, 7.5), 0.2)
    state, wanted = controller.step(controller.initial(sample(0.0, 7.5), 0.2), sample(0.0, 7.5), 0.2, 0.1)
    assert drive.command(0.2) == wanted
    drive.saw(sample(0.05, wanted), 0.3)
    assert drive.command(0.3) == controller.step(state, sample(0.05, wanted), 0.3, 0.1)[1]
    assert drive.target_in(0.3) == 0.3
