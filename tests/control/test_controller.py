"""Every controller that is found keeps the contract of `control/controller.py`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from app.physics_bench import open_virtual
from control.controller import (
    FOLDER,
    Controller,
    controller_class,
    controller_names,
    make_controller,
    parse_settings,
    setting_defaults,
)
from control.design import DesignModel
from hal.errors import BadInput
from hal.sample import Quality, Reading, Sample

DESIGN = DesignModel()
NAMES = controller_names()
THESIS = {"open_loop", "p", "p_incremental", "pi", "pi_antiwindup", "if_then_constant", "if_then_line", "if_then_pi"}
WINDS_UP = {"pi"}  # on purpose: the thesis's first try
HOLDS_STILL = {"open_loop", "p"}  # laws without memory; their hand-over fades, see test_handover
DT_S = 0.1


def sample(position: float, pressure: float, commanded: float, quality: Quality = Quality.GOOD) -> Sample:
    return Sample(0.0, commanded, Reading(position, 0.0, 0.0, quality), Reading(pressure, 0.0, 0.0))


def closed_loop(name: str, targets: list[float], **settings: float) -> tuple[list[Sample], list[float]]:
    """Samples and commands of a run of the virtual valve with noise."""
    opened = open_virtual(3)
    controller = make_controller(name, DESIGN, **settings)
    seen = [opened.bench.exchange(0.0)]
    state, commands = controller.initial(seen[0], targets[0]), []
    for tick, target in enumerate(targets):
        state, command = controller.step(state, seen[-1], target, DT_S)
        commands.append(command)
        opened.clock.sleep_until((tick + 1) * DT_S)
        seen.append(opened.bench.exchange(command))
    return seen, commands


def test_the_thesis_is_there_and_rivals_besides() -> None:
    assert set(NAMES) >= THESIS | {"inverse_pi", "prandtl_ishlinskii", "scheduled_pi", "mpc", "overdrive", "brake"}


def test_every_file_offers_a_controller() -> None:
    assert [path.stem for path in sorted(FOLDER.glob("*.py")) if path.stem != "__init__"] == sorted(NAMES)
    for name in NAMES:
        assert controller_class(name).__doc__


@pytest.mark.parametrize("name", NAMES)
def test_replay_is_bit_exact(name: str) -> None:
    targets = [0.25] * 60 + [0.4] * 40 + [0.1] * 60
    seen, commands = closed_loop(name, targets)
    again = make_controller(name, DESIGN)
    state, replayed = again.initial(seen[0], targets[0]), []
    for reading, target in zip(seen, targets, strict=False):
        shifted = replace(reading, time_s=reading.time_s + 1e6)  # no controller may look at the clock
        state, command = again.step(state, shifted, target, DT_S)
        replayed.append(command)
    assert replayed == commands


@pytest.mark.parametrize("name", NAMES)
def test_commands_stay_in_range(name: str) -> None:
    _, commands = closed_loop(name, [0.5] * 60 + [0.0] * 60, min_psi=3.0, max_psi=11.0)
    assert min(commands) >= 3.0
    assert max(commands) <= 11.0


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "bad",
    [
        sample(float("nan"), 8.0, 7.5),
        sample(0.2, float("nan"), 7.5),
        sample(0.2, 8.0, 7.5, Quality.MISSING),
        sample(0.2, 8.0, 7.5, Quality.IMPLAUSIBLE),
    ],
)
def test_an_unusable_sample_holds_the_command_and_the_state(name: str, bad: Sample) -> None:
    controller = make_controller(name, DESIGN)
    before = controller.initial(sample(0.2, 8.0, 7.5), 0.2)
    after, command = controller.step(before, bad, 0.3, DT_S)
    assert command == 7.5
    assert after == before


@pytest.mark.parametrize("name", NAMES)
def test_a_target_that_is_not_a_number_holds_too(name: str) -> None:
    controller = make_controller(name, DESIGN)
    state = controller.initial(sample(0.2, 8.0, 7.5), 0.2)
    assert controller.step(state, sample(0.2, 8.0, 7.5), float("nan"), DT_S)[1] == 7.5


@pytest.mark.parametrize("name", NAMES)
def test_starting_without_readings_does_not_fail(name: str) -> None:
    controller = make_controller(name, DESIGN)
    state = controller.initial(sample(float("nan"), float("nan"), 7.5, Quality.MISSING), 0.3)
    assert 0.0 <= controller.step(state, sample(0.3, 8.0, 7.5), 0.3, DT_S)[1] <= 20.0


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("pressure", [7.6, 9.0, 10.0])
def test_hand_over_at_rest_on_the_target_is_bumpless(name: str, pressure: float) -> None:
    controller = make_controller(name, DESIGN)
    at_rest = sample(0.25, pressure, pressure)
    command = controller.step(controller.initial(at_rest, 0.25), at_rest, 0.25, DT_S)[1]
    assert command == pytest.approx(pressure, abs=0.2)


@pytest.mark.parametrize("name", sorted(set(NAMES) - WINDS_UP - HOLDS_STILL))
def test_nothing_winds_up(name: str) -> None:
    """A target out of reach of a low supply for long, then one within reach: the command turns within 12 s."""
    assert turns_after_s(make_controller(name, DESIGN, max_psi=9.5)) < 12.0


def test_plain_pi_winds_up() -> None:
    assert turns_after_s(make_controller("pi", DESIGN, max_psi=9.5)) > 30.0


def turns_after_s(controller: Controller[Any]) -> float:
    opened = open_virtual(0, noise=0.0)
    seen = opened.bench.exchange(0.0)
    state = controller.initial(seen, 0.5)
    for tick in range(3000):
        target = 0.5 if tick < 1500 else 0.02
        state, command = controller.step(state, seen, target, DT_S)
        if tick >= 1500 and command < 9.5 - 0.3:
            return (tick - 1500) * DT_S
        opened.clock.sleep_until((tick + 1) * DT_S)
        seen = opened.bench.exchange(command)
    return float("inf")


@pytest.mark.parametrize("name", NAMES)
def test_settings_make_the_same_controller_again(name: str) -> None:
    controller = make_controller(name, DESIGN)
    assert make_controller(name, DESIGN, **controller.settings) == controller
    assert set(controller.settings) == set(setting_defaults(name))


def test_bad_input_is_one_clear_sentence() -> None:
    with pytest.raises(BadInput, match="does not exist; choose one of"):
        make_controller("pid", DESIGN)
    with pytest.raises(BadInput, match="has no setting 'kd'"):
        make_controller("pi", DESIGN, kd=1.0)
    with pytest.raises(BadInput, match="should be a number"):
        make_controller("pi", DESIGN, kp="much")
    with pytest.raises(BadInput, match="not a finite number"):
        make_controller("pi", DESIGN, kp=float("inf"))
    with pytest.raises(BadInput, match="not below max_psi"):
        make_controller("pi", DESIGN, min_psi=20.0)
    with pytest.raises(BadInput, match="convert the design model"):
        make_controller("pi", replace(DESIGN, pressure_unit="kPa"))


def test_settings_from_words() -> None:
    assert parse_settings(["kp=4", "mode=fast"]) == {"kp": 4.0, "mode": "fast"}
    with pytest.raises(BadInput, match="not of the form key=value"):
        parse_settings(["kp"])
