"""What comes back in a repeat is a model's error; what does not is noise, or a disturbance when it is loud."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import DESIGN, staircase, trial_of
from twin.diagnose import diagnose
from twin.fit.case import make_case
from twin.fit.smooth import smoothed_pressure
from twin.fit.trial import Trial
from twin.judge.repeatable import disturbance, repeated_share
from twin.model.plant import Plant
from twin.ready.lateness import late_commands


def twice(rows: int = 1500) -> FloatArray:
    return np.tile(staircase()[:rows], 2)


def rest_of(trial: Trial, kind: str) -> FloatArray:
    rng = np.random.default_rng(5)
    half = np.sin(np.arange(trial.recording.n // 2) / 40.0)
    return np.tile(half, 2) if kind == "model" else rng.normal(0.0, 1.0, trial.recording.n)


@pytest.mark.parametrize(("kind", "low", "high"), [("model", 0.99, 1.01), ("noise", -0.1, 0.1)])
def test_share_that_repeats(kind: str, low: float, high: float) -> None:
    trial, _ = trial_of(Plant(DESIGN), twice())
    share = repeated_share(rest_of(trial, kind), [trial])
    assert share is not None
    assert low < share < high


def test_without_repeats_nothing_is_said() -> None:
    trial, _ = trial_of(Plant(DESIGN), staircase())
    assert repeated_share(rest_of(trial, "noise"), [trial]) is None


def recorded(wander: float, late_s: float = 0.0) -> Recording:
    """A healthy valve run twice with measured pressure; `wander`: a swing of the reading that does not repeat."""
    trial, true = trial_of(Plant(DESIGN), twice())
    r = trial.recording
    rng = np.random.default_rng(3)
    swing = wander * np.sin(2.0 * np.pi * r.time_s / 17.3)
    pressure = np.asarray(r.pressure)
    if late_s:
        pressure = np.interp(r.time_s - late_s, r.time_s, pressure)
    noisy = pressure + rng.normal(0.0, 8e-3, r.n)
    return replace(r, position=true + swing + rng.normal(0.0, 6e-4, r.n), pressure=noisy)


@pytest.mark.thorough
def test_a_loud_swing_that_does_not_repeat_is_unexplained_and_described() -> None:
    swinging = recorded(0.02)
    loud = disturbance(make_case([swinging], DESIGN))
    assert loud is not None
    assert loud.signal == "position"
    found = diagnose([swinging], DesignModel(), (), UP_TO_TWO).diagnosis
    assert found.verdict == "unexplained"
    signature = found.residual_signature
    assert signature["strongest_frequency_hz"] == pytest.approx(1.0 / 17.3, rel=0.15)
    assert "does_not_repeat" in signature


@pytest.mark.thorough
def test_beside_a_measured_pressure_a_smaller_swing_shows() -> None:
    """Less than `LOUD` and `MATERIAL` ask for."""
    healthy = recorded(0.0)
    slow = gaussian_filter1d(np.random.default_rng(4).normal(0.0, 1.0, healthy.n), 25.0)
    restless = replace(healthy, position=healthy.position + 0.002 * slow / slow.std())
    assert disturbance(make_case([restless], DESIGN)) is None
    found = diagnose([restless], DesignModel(), (), UP_TO_TWO).diagnosis
    assert found.verdict == "unexplained"
    assert found.gap.before > 2.0 * found.gap.noise_floor
    assert diagnose([replace(restless, pressure=None)], DesignModel(), (), UP_TO_TWO).diagnosis.verdict == "no_gap"


def test_a_pressure_that_wanders_and_is_measured_is_no_disturbance() -> None:
    trial, _ = trial_of(Plant(DESIGN), twice(2000))
    command = trial.recording.command
    wandering = command + 0.025 * np.sin(2.0 * np.pi * trial.recording.time_s / 23.7)
    moved = trial_of(Plant(DESIGN), wandering)[0].recording
    noise = np.random.default_rng(3).normal(0.0, 8e-3, moved.n)
    case = make_case([replace(moved, command=command, pressure=np.asarray(moved.pressure) + noise)], DESIGN)
    known = case.noise.position.by_source
    assert known["repeats"] > 2.0 * known["still"]
    assert case.sigma_p is not None
    driven = [t.with_pressure(smoothed_pressure(case.base, t, case.sigma_p)) for t in case.trials]
    assert disturbance(case, driven) is None


@pytest.mark.thorough
def test_a_healthy_valve_has_no_disturbance() -> None:
    healthy = recorded(0.0)
    assert disturbance(make_case([healthy], DESIGN)) is None
    assert diagnose([healthy], DesignModel(), (), UP_TO_TWO).diagnosis.verdict == "no_gap"


def from_a_stop(psi: float, seed: int, wander: float = 0.0) -> Recording:
    """A healthy valve that comes from a stop and swings further and further about the middle of its deadband."""
    t = np.arange(0.0, 300.0, 0.1)
    command = np.concatenate([np.full(300, psi), 7.3 + 2.0 * t / 300.0 * np.sin(t / 3.0)])
    trial, true = trial_of(Plant(DESIGN), command)
    noise = np.random.default_rng(seed).normal(0.0, 6e-4, true.size)
    swing = wander * np.sin(trial.recording.time_s / 2.9)
    return replace(trial.recording, position=true + swing + noise)


def test_repeats_that_begin_elsewhere_are_no_disturbance() -> None:
    """A play keeps where it came from as long as nothing swings it further, and the design knows that."""
    ends = [from_a_stop(3.0, 1), from_a_stop(14.0, 2)]
    noise = make_case(ends, DESIGN).noise.position
    assert noise.source != "repeats" and noise.by_source["repeats"] > 5.0 * noise.sigma
    assert disturbance(make_case(ends, DESIGN)) is None
    disturbed = [ends[0], from_a_stop(14.0, 2, wander=0.03)]
    assert disturbance(make_case(disturbed, DESIGN)) is not None


def test_a_few_milliseconds_are_timing_and_a_quarter_of_a_second_is_not() -> None:
    late, notes = late_commands(make_case([recorded(0.0, 0.008)], DESIGN))
    assert late[0].values[0] == pytest.approx(0.008, abs=0.002)
    assert "ms after their rows' time" in notes[0].what
    assert late_commands(make_case([recorded(0.0)], DESIGN)) == ((), [])
    late_and_noisy = recorded(0.0, 0.008)
    assert late_and_noisy.pressure is not None
    noise = np.random.default_rng(1).normal(0.0, 0.02, late_and_noisy.n)
    unblamed = replace(late_and_noisy, pressure=late_and_noisy.pressure + noise)  # the design explains it to its noise
    assert late_commands(make_case([unblamed], DESIGN)) == ((), [])
    assert late_commands(make_case([recorded(0.0, 0.25)], DESIGN)) == ((), [])


@pytest.mark.thorough
def test_timing_is_neither_a_cause_nor_in_the_model() -> None:
    outcome = diagnose([recorded(0.0, 0.008)], DesignModel(), (), UP_TO_TWO)
    assert outcome.diagnosis.verdict == "no_gap"
    assert not outcome.model.effects


def twice_through(jumps_in: float = 0.0, step_in: float = 0.0) -> Recording:
    """A healthy valve run twice: its reading jumps now and then by so much, or is so coarse."""
    dice, healthy = np.random.default_rng(6), recorded(0.0)
    at = np.arange(healthy.n) // 150
    position = healthy.position + jumps_in * dice.integers(0, 2, at[-1] + 1)[at]
    return replace(healthy, position=step_in * np.round(position / step_in) if step_in else position)


@pytest.mark.parametrize(
    ("how", "disturbed"),
    [({}, False), ({"jumps_in": 0.0006}, False), ({"jumps_in": 0.003}, True), ({"step_in": 0.006}, False)],
)
def test_what_healthy_machines_never_do_between_repeats(how: dict[str, float], disturbed: bool) -> None:
    case = make_case([twice_through(**how)], DESIGN)
    assert case.sigma_p is not None
    driven = [t.with_pressure(smoothed_pressure(case.base, t, case.sigma_p)) for t in case.trials]
    assert (disturbance(case, driven) is not None) is disturbed
