"""Rests of the stem: found where it stands, not where it creeps in; a model told there does not carry a miss along."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.catalog import effect
from twin.fit.channel import position_channel
from twin.fit.rests import find_rests
from twin.fit.trial import Trial, make_trial
from twin.plant import Inserted, Plant, pressure_response, reading_response, stem_response

DESIGN = DesignModel()
SIGMA = 5e-4
TRAVEL = DESIGN.travel


def staircase(seed: int = 1) -> FloatArray:
    """Levels of 25 s at 0.1 s, large and small, both ways."""
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform(6.0, 11.5, 16), 250)


def trial_of(plant: Plant, command: FloatArray, seed: int = 2) -> tuple[Trial, FloatArray]:
    """What the plant would record, ready for the position channel, and its true reading."""
    time_s = np.arange(command.size) * 0.1
    blank = Recording("x", time_s, command, np.zeros(command.size), None)
    grid = make_trial(blank, 0.05).grid
    c = plant.coefficients(float(time_s[-1]))
    pressure = pressure_response(c, grid, command, float(command[0]))
    true = reading_response(c, grid, stem_response(c, grid, pressure, 0.0, 0.0))
    noisy = true + np.random.default_rng(seed).normal(0.0, SIGMA, true.size)
    recording = replace(blank, position=noisy, pressure=pressure[grid.offsets])
    return make_trial(recording, 0.05).with_pressure(pressure), true


def test_rests_are_where_the_stem_stands() -> None:
    trial, true = trial_of(Plant(DESIGN), staircase())
    rests = find_rests(trial.recording.time_s, trial.recording.position, trial.use_y, SIGMA, 1.0, TRAVEL)
    assert rests.rows.size >= 5
    speed = np.abs(np.gradient(true, 0.1))[rests.rows]
    assert DESIGN.tau_s * speed.max() < 1.5 * SIGMA  # what is left of the way
    np.testing.assert_allclose(rests.reading, true[rests.rows], atol=3.0 * SIGMA)


def test_a_stem_that_never_rests_has_none() -> None:
    time_s = np.arange(2000) * 0.1
    reading = 0.28 + 0.2 * np.sin(time_s) + np.random.default_rng(0).normal(0.0, SIGMA, time_s.size)
    assert find_rests(time_s, reading, np.ones(2000, dtype=bool), SIGMA, 1.0, TRAVEL).rows.size == 0


def test_gaps_and_false_readings_are_no_rest() -> None:
    time_s = np.arange(400) * 0.1
    reading = np.full(400, 0.3)
    use = np.ones(400, dtype=bool)
    assert find_rests(time_s, reading, use, SIGMA, 1.0, TRAVEL).rows.size == 2  # first and last
    use[::2] = False
    assert find_rests(time_s, reading, use, SIGMA, 1.0, TRAVEL).rows.size == 0
    assert find_rests(np.arange(10) * 0.1, reading[:10], use[:10], SIGMA, 1.0, TRAVEL).rows.size == 0


@pytest.mark.parametrize(
    ("name", "form", "values"),
    [
        ("lvdt_calibration", "gain_and_zero", (0.02, 0.004)),
        ("lvdt_nonlinearity", "bow", (0.02,)),
        ("lvdt_drift", "linear", (2e-5,)),
        ("linkage_lost_motion", "play", (0.01,)),
        ("creep", "one_tail", (0.05, 20.0)),
        ("distributed_hysteresis", "uniform", (0.3,)),
        ("additional_lag", "after_play", (0.6,)),
        ("stiction", "target_sticks", (0.3, 4e-3)),
    ],
)
def test_the_true_model_gains_nothing_by_being_told(name: str, form: str, values: tuple[float, ...]) -> None:
    plant = Plant(DESIGN, (Inserted(name, effect(name).form(form), values),))
    trial, _ = trial_of(plant, staircase())
    told = trial.with_rests(SIGMA, 1.0, TRAVEL)
    assert told.rests is not None
    assert told.rests.rows.size >= 4
    r = position_channel([told], SIGMA).residuals(plant)
    assert float(np.mean(np.square(r))) < 1.6
    free = position_channel([trial], SIGMA).residuals(plant)
    assert float(np.mean(np.square(free))) < 1.2


def test_one_other_decision_is_not_carried_along() -> None:
    """A step slips the true valve and not the model; then nothing moves for minutes. Told, it loses that move only."""
    form = effect("stiction").form("target_sticks")
    truth, other = (Plant(DESIGN, (Inserted("stiction", form, (s, 4e-3)),)) for s in (0.3, 0.33))
    closed = DESIGN.a1 + 0.25 / DESIGN.compliance
    levels = np.concatenate([[closed, closed + 0.315], closed + 0.2 - 0.1 * (np.arange(12) % 3)])
    trial, _ = trial_of(truth, np.repeat(levels, 300))
    told = trial.with_rests(SIGMA, 1.0, TRAVEL)
    free_mse, told_mse = (float(np.mean(position_channel([t], SIGMA).residuals(other) ** 2)) for t in (trial, told))
    assert free_mse > 1000.0
    assert told_mse < 0.1 * free_mse


def test_a_settling_stem_does_not_rest_yet() -> None:
    """The stretch in which the last of a move is below the noise of its slope is not taken for the rest after it."""
    time_s = np.arange(600) * 0.1
    true = 0.1 + 0.2 * np.exp(-np.maximum(time_s - 10.0, 0.0) / 2.7)
    reading = true + np.random.default_rng(5).normal(0.0, SIGMA, 600)
    rests = find_rests(time_s, reading, np.ones(600, dtype=bool), SIGMA, 1.0, TRAVEL)
    assert rests.rows.size in (3, 4)  # before the move one or two, after it two
    assert np.abs(rests.reading - true[rests.rows]).max() < 1.5 * SIGMA
    after = rests.rows[rests.rows > 110]
    assert np.abs(true[after] - true[-1]).max() < 2.0 * SIGMA


def test_no_rests_is_bit_for_bit_the_free_model() -> None:
    plant = Plant(DESIGN)
    trial, _ = trial_of(plant, staircase())
    empty = find_rests(np.arange(4) * 0.1, np.zeros(4), np.ones(4, dtype=bool), SIGMA, 1.0, TRAVEL)
    one, other = (position_channel([t], SIGMA).residuals(plant) for t in (trial, replace(trial, rests=empty)))
    assert np.array_equal(one, other)
