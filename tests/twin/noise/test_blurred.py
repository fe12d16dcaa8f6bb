"""Steps that a gauge made before noise came to its reading: seen in motion, and taken off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.model.plant import Plant
from twin.noise.blurred import blurred_step, on_their_steps

STEP_IN = 0.004


def read(noise: float, step_in: float = STEP_IN, place: float = 0.3, seed: int = 1) -> Recording:
    """A healthy valve read in steps, one of them at `place` (in steps), with `noise` (in steps) on top."""
    record = a_record(Plant(DesignModel()), n=3000)
    steps = np.round(record.position / step_in - place) + place if step_in else record.position / STEP_IN
    blur = np.random.default_rng(seed).normal(0.0, noise, record.n)
    return replace(record, position=(step_in or STEP_IN) * (steps + blur))


@settings(max_examples=15, deadline=None)
@given(st.floats(0.03, 0.1), st.floats(-0.5, 0.5), st.floats(0.003, 0.012))
def test_the_step_is_found_and_every_reading_taken_for_one(noise: float, place: float, step_in: float) -> None:
    blurred = read(noise, step_in, place)
    (snapped,), notes = on_their_steps([blurred], noise * step_in)
    step, at = blurred_step([blurred], noise * step_in)
    assert step == pytest.approx(step_in, rel=1e-3)
    off = (snapped.position - at) / step
    np.testing.assert_allclose(off, np.round(off), atol=1e-9)
    assert np.max(np.abs(snapped.position - read(0.0, step_in, place).position)) < 0.1 * step_in
    assert "noise that came after" in notes[0].what


@pytest.mark.parametrize("noise", [0.05, 0.12])
def test_a_reading_without_steps_is_left_alone(noise: float) -> None:
    smooth = read(noise, step_in=0.0)
    (same,), notes = on_their_steps([smooth], noise * STEP_IN)
    assert same is smooth and not notes


def test_steps_among_which_noise_makes_a_reading_another_one_are_left_alone() -> None:
    for noise in (0.15, 0.4):
        assert blurred_step([read(noise)], noise * STEP_IN) == (0.0, 0.0)


def test_readings_at_rest_crowd_without_steps() -> None:
    noise_in = np.random.default_rng(0).normal(0.0, 1e-4, 3000)
    rests = replace(read(0.0, step_in=0.0), position=np.repeat([0.1, 0.2, 0.3, 0.4], 750) + noise_in)
    assert blurred_step([rests], 1e-4) == (0.0, 0.0)


def test_readings_without_noise_are_left_alone() -> None:
    assert blurred_step([read(0.0, step_in=0.0)], 1e-18) == (0.0, 0.0)


@pytest.mark.thorough
@pytest.mark.parametrize(("step_in", "noise"), [(0.008, 0.1), (0.012, 0.08)])
def test_a_digital_gauge_behind_an_analog_line_is_a_coarse_one(step_in: float, noise: float) -> None:
    found = diagnose([read(noise, step_in)], DesignModel(), (), UP_TO_TWO).diagnosis
    assert [c.name for c in found.causes] == ["sensor_quantization"]
    assert found.causes[0].parameters["step"].value == pytest.approx(step_in, rel=0.01)
    assert any("noise that came after" in note.what for note in found.data_quality)


def test_false_readings_beside_a_stem_at_rest_are_no_motion() -> None:
    """Levels of a staircase lie steps apart, and a spike three rows away makes each of them look like a passage."""
    dice, rows = np.random.default_rng(6), 12_000
    levels = 0.05 * np.repeat(dice.integers(0, 11, 20), rows // 20)
    false = dice.random(rows) < 0.05
    position = levels + dice.normal(0.0, 1e-3, rows) + np.where(false, dice.uniform(0.03, 0.1, rows), 0.0)
    record = Recording("staircase", 0.05 * np.arange(rows), levels, position)
    assert blurred_step([record], 1e-3) == (0.0, 0.0)


@pytest.mark.parametrize("code", [-9999.0, 1e6])
def test_a_code_for_no_value_makes_no_step_of_all_readings(code: float) -> None:
    """Every reading would be the same then, and what moves something else."""
    smooth = read(0.12, step_in=0.0)
    rows = np.random.default_rng(4).choice(smooth.n, 60, replace=False)
    coded = replace(smooth, position=np.where(np.isin(np.arange(smooth.n), rows), code, smooth.position))
    (same,), notes = on_their_steps([coded], 0.12 * STEP_IN)
    assert same is coded and not notes
