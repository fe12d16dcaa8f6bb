"""Steps that a historian made of what it stores are no fault of the gauge; those of a converter are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import FloatArray, Recording
from logs.spoken import WRITTEN
from tests.twin.trials import DESIGN, trial_of
from twin.model.plant import Plant
from twin.noise.model import estimate_noise
from twin.record.recorder import recorder_note, rounded_by_recorder
from twin.record.sensing import Sensing, sense

TENTH = 0.001 * DESIGN.travel


def wandering(seed: int = 4) -> FloatArray:
    """What a loop commands in 400 s: other changes all the time [psi]."""
    steps = np.random.default_rng(seed).normal(0.0, 0.25, 200)
    return np.repeat(9.0 + 1.5 * np.sin(np.cumsum(steps)), 20)


def stored(command_step: float, position_step: float, command: FloatArray | None = None) -> Recording:
    trial, position = trial_of(Plant(DESIGN), wandering() if command is None else command)
    position = position + np.random.default_rng(5).normal(0.0, 2e-4, position.size)
    rounded = [np.round(v / s) * s for v, s in ((trial.recording.command, command_step), (position, position_step))]
    return Recording("loop", trial.recording.time_s, rounded[0], rounded[1])


def sensed(record: Recording) -> Sensing:
    return sense([record], estimate_noise([record]), DESIGN)


def test_what_is_stored_in_round_steps_beside_commands_alike_is_the_recorders() -> None:
    found = sensed(stored(0.02, 2.0 * TENTH))
    assert found.recorded and "sensor_quantization" not in found.accepted
    assert found.step == pytest.approx(2.0 * TENTH, rel=1e-3)


@pytest.mark.parametrize(
    ("command_step", "position_step"),
    [(0.02, 1.71 * TENTH), (0.0005, 2.0 * TENTH), (0.02, 10.0 * TENTH)],
    ids=["not round", "fine commands", "too coarse for a recorder"],
)
def test_a_converter_of_its_own_is_named(command_step: float, position_step: float) -> None:
    found = sensed(stored(command_step, position_step))
    assert not found.recorded and "sensor_quantization" in found.accepted


def test_a_staircase_that_was_typed_in_says_nothing_of_a_recorder() -> None:
    levels = np.repeat(np.concatenate([np.arange(6.0, 11.0, 0.1), np.arange(11.0, 6.0, -0.1)]), 40)
    assert not rounded_by_recorder([stored(0.02, 2.0 * TENTH, levels)], 2.0 * TENTH, DESIGN.travel)


def test_round_is_what_is_round_in_percent_of_travel_or_in_the_unit() -> None:
    inch = stored(0.02, 0.001)
    assert rounded_by_recorder([inch], 0.001, DESIGN.travel)
    assert not rounded_by_recorder([inch], 0.00093, DESIGN.travel)


@pytest.mark.parametrize(("written", "round_one"), [("mm", True), ("in", False), ("V(0..10=0..0.5625 in)", False)])
def test_round_is_what_is_round_in_the_unit_of_the_file(written: str, round_one: bool) -> None:
    step_in = 0.05 / 25.4
    one = replace(stored(0.02, step_in), meta={WRITTEN: {"command": "psi", "position": written}})
    assert rounded_by_recorder([one], step_in, DESIGN.travel) is round_one


def test_it_is_said_how_fine_the_record_is() -> None:
    note = recorder_note([stored(0.02, 2.0 * TENTH)], 2.0 * TENTH)
    assert "0.00113 in" in note.what and "no fault of the gauge" in note.handled and note.rows == 4000
