"""Interference on a reading hides in its own noise; it is found as one line, and random noise is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.diagnose import diagnose
from twin.diagnosis import Cause
from twin.judge.gap import GapParts
from twin.judge.swing import swing_of
from twin.judge.upheld import upheld
from twin.judge.verdict import Judgement
from twin.model.plant import Plant
from twin.record.sensing import Sensing


@pytest.mark.parametrize(("frequency_hz", "amplitude"), [(1.37, 0.003), (4.21, 0.002)])
def test_a_swing_is_found_with_its_frequency_and_amplitude(frequency_hz: float, amplitude: float) -> None:
    trial, _ = trial_of(Plant(DESIGN), staircase())
    noise = np.random.default_rng(3).normal(0.0, SIGMA, trial.recording.n)
    error = noise + amplitude * np.sin(2.0 * np.pi * frequency_hz * trial.recording.time_s + 0.7)
    swing = swing_of(error, (trial,))
    assert swing is not None
    assert swing.frequency_hz == pytest.approx(frequency_hz, abs=2e-4)
    assert swing.amplitude == pytest.approx(amplitude, rel=0.03)
    assert swing.share == pytest.approx(0.5 * amplitude**2 / (0.5 * amplitude**2 + SIGMA**2), abs=0.02)


def test_a_swing_that_comes_and_goes_is_found() -> None:
    """A pipe that vibrates: no line has half of it, the band has nearly all."""
    r = trial_of(Plant(DESIGN), staircase())[0]
    time_s = r.recording.time_s
    swings = (1.0 + 0.9 * np.sin(0.11 * time_s)) * np.sin(2.0 * np.pi * 0.9 * time_s + 2.0 * np.sin(0.07 * time_s))
    error = np.random.default_rng(8).normal(0.0, SIGMA, time_s.size) + 0.004 * swings
    swing = swing_of(error, (r,))
    assert swing is not None and swing.frequency_hz == pytest.approx(0.9, abs=0.05)
    assert swing.amplitude == pytest.approx(0.004 * np.sqrt(2.0 * np.mean(swings**2)), rel=0.1)
    swept = replace(r, recording=replace(r.recording, command=7.0 + swings))
    assert swing_of(error, (swept,)) is None


def test_rows_that_come_unevenly_blur_no_line() -> None:
    trial, _ = trial_of(Plant(DESIGN), staircase())
    dice = np.random.default_rng(5)
    r = trial.recording
    time_s = r.time_s + 0.2 * r.period_s * dice.uniform(-1.0, 1.0, r.n)
    time_s[1:-1:2] += 0.05 * r.period_s  # the median step is not the mean one
    error = dice.normal(0.0, SIGMA, r.n) + 0.003 * np.sin(2.0 * np.pi * 0.487 * time_s)
    swing = swing_of(error, (replace(trial, recording=replace(r, time_s=time_s)),))
    assert swing is not None and swing.frequency_hz == pytest.approx(0.487, abs=2e-4)


def test_an_answer_to_a_command_that_swings_is_no_swing() -> None:
    trial, _ = trial_of(Plant(DESIGN), staircase())
    r = trial.recording
    sine = np.sin(2.0 * np.pi * 0.3 * r.time_s)
    error = np.random.default_rng(6).normal(0.0, SIGMA, r.n) + 0.004 * sine
    assert swing_of(error, (trial,)) is not None
    swept = replace(trial, recording=replace(r, command=7.0 + 2.0 * np.roll(sine, 3)))
    assert swing_of(error, (swept,)) is None


@pytest.mark.thorough
def test_a_pressure_that_swings_by_itself_is_unexplained() -> None:
    recording = trial_of(Plant(DESIGN), staircase()[:2500])[0].recording
    assert recording.pressure is not None
    ripple = 0.05 * np.sin(2.0 * np.pi * 0.21 * recording.time_s)
    outcome = diagnose([replace(recording, pressure=recording.pressure + ripple)], DESIGN, (), UP_TO_TWO)
    assert outcome.diagnosis.verdict == "unexplained"
    signature = outcome.diagnosis.residual_signature
    assert signature is not None
    swings = signature["swings"]
    assert isinstance(swings, dict) and swings["signal"] == "pressure" and swings["unit"] == "psi"
    assert any("regulator" in note.handled for note in outcome.diagnosis.data_quality)


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.995])
def test_noise_with_or_without_a_memory_does_not_swing(memory: float) -> None:
    trial, _ = trial_of(Plant(DESIGN), staircase())
    dice = np.random.default_rng(4).normal(0.0, SIGMA, trial.recording.n)
    error = np.empty_like(dice)
    error[0] = dice[0]
    for k in range(1, dice.size):
        error[k] = memory * error[k - 1] + dice[k]
    assert swing_of(error, (trial,)) is None
    assert swing_of(error[:100], (replace(trial, recording=trial.recording.slice(0, 100)),)) is None


@pytest.mark.thorough
def test_a_healthy_valve_with_interference_is_unexplained_and_the_operator_told_where_to_look() -> None:
    recording = trial_of(Plant(DESIGN), staircase()[:2500])[0].recording
    hum = 0.003 * np.sin(2.0 * np.pi * 1.37 * recording.time_s)
    outcome = diagnose([replace(recording, position=recording.position + hum)], DESIGN, (), UP_TO_TWO)
    assert outcome.diagnosis.verdict == "unexplained"
    signature = outcome.diagnosis.residual_signature
    assert signature is not None
    swings = signature["swings"]
    assert isinstance(swings, dict) and swings["frequency_hz"] == pytest.approx(1.37, abs=1e-3)
    assert any("swings by itself" in note.what for note in outcome.diagnosis.data_quality)
    assert diagnose([recording], DESIGN, (), UP_TO_TWO).diagnosis.verdict == "no_gap"


@pytest.mark.parametrize(
    ("swings", "exact", "verdict"), [(True, False, "unexplained"), (True, True, "effect"), (False, False, "effect")]
)
def test_beside_what_swings_by_itself_only_what_leaves_nothing_is_believed(
    swings: bool, exact: bool, verdict: str
) -> None:
    """A pilot that hunts shakes the stem through its friction: the deadband looks smaller, and creep was named."""
    levels = GapParts(*(np.full(8, level) for level in (8.0, 1.7, 1.7)), {}, {})
    creep = Judgement("effect", (Cause("creep", "actuator", 0.9, None, {}),), (), ())
    told = (True, 1.0, swings, exact, (), swings)
    assert upheld(levels, creep, 1.0, Sensing((), {}, 0.0), *told)[1].verdict == verdict
