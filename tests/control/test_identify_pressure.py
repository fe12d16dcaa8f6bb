"""The E/P stage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.identify_model import lagged, make_grid
from control.identify_pressure import fit_pressure, moving_average
from control.identify_tracks import drive_of, unit_doubt
from tests.control.toy_valve import Toy, random_steps, record

TIME_S = np.arange(0.0, 200.0, 0.1)
COMMAND = random_steps(200.0, 0.1)
GRID = make_grid(TIME_S)


def readings(tau_s: float, noise: float = 0.004, seed: int = 0) -> np.ndarray:
    clean = lagged(GRID, COMMAND, tau_s, 4.0)[GRID.first]
    return np.asarray(clean + noise * np.random.default_rng(seed).standard_normal(TIME_S.size))


@pytest.mark.parametrize("tau_s", [0.05, 0.3, 2.0])
def test_the_lag_is_found_with_an_interval(tau_s: float) -> None:
    stage = fit_pressure(GRID, COMMAND, readings(tau_s), 0.3)
    assert stage.tau_s is not None
    assert stage.tau_s.value == pytest.approx(tau_s, rel=0.01)
    assert stage.tau_s.half_width < 0.01 * tau_s


def test_gain_and_zero_do_not_spoil_it() -> None:
    stage = fit_pressure(GRID, COMMAND, 1.04 * readings(0.3) - 0.2, 0.3)
    assert stage.tau_s is not None
    assert stage.tau_s.value == pytest.approx(0.3, rel=0.01)
    assert (stage.gain, stage.zero) == pytest.approx((1.04, -0.2), abs=0.005)
    assert not stage.is_calibrated


def test_false_and_missing_readings_do_not_pull() -> None:
    pressure = readings(0.3)
    pressure[::41] = 20.0
    pressure[::17] = np.nan
    stage = fit_pressure(GRID, COMMAND, pressure, 0.3)
    assert stage.tau_s is not None
    assert stage.tau_s.value == pytest.approx(0.3, rel=0.02)


def test_the_smoothed_pressure_is_closer_to_the_truth_than_the_readings() -> None:
    stage = fit_pressure(GRID, COMMAND, readings(0.3), 0.3)
    truth = lagged(GRID, COMMAND, 0.3, 4.0)
    assert np.std(stage.fine - truth) < 0.0008
    assert np.abs(stage.fine - truth).max() < 0.005


@pytest.mark.parametrize("missing", [1, 3])
@pytest.mark.parametrize("memory_rows", [1, 5])
def test_the_doubts_are_as_large_as_what_the_smoothing_leaves_of_the_noise(missing: int, memory_rows: int) -> None:
    true, doubted = [], []
    box = np.ones(memory_rows) / memory_rows**0.5
    for seed in range(12):
        noise = 0.004 * np.convolve(np.random.default_rng(seed).standard_normal(TIME_S.size), box, "same")
        pressure = readings(0.3, noise=0.0) + noise
        if missing > 1:
            pressure[::missing] = np.nan
        stage = fit_pressure(GRID, COMMAND, pressure, 0.3)
        good = np.isfinite(pressure)
        true.append(np.var(moving_average(TIME_S, np.where(good, noise, 0.0), good, stage.width_s)))
        doubted.append(np.var(stage.doubts))
    assert np.mean(doubted) == pytest.approx(np.mean(true), rel=0.3)


def test_a_slow_disturbance_that_is_really_there_is_kept() -> None:
    wave = 0.1 * np.sin(TIME_S / 15.0)
    stage = fit_pressure(GRID, COMMAND, readings(0.3) + wave, 0.3)
    truth = lagged(GRID, COMMAND, 0.3, 4.0)[GRID.first] + wave
    assert np.std(stage.fine[GRID.first] - truth) < 0.01


def test_a_ramp_does_not_tell_the_lag_and_the_default_is_kept() -> None:
    ramp = np.linspace(7.0, 7.05, TIME_S.size)
    pressure = ramp + 0.004 * np.random.default_rng(0).standard_normal(TIME_S.size)
    assert fit_pressure(GRID, ramp, pressure, 0.3).tau_s is None


def test_the_moving_average_has_no_phase_and_steps_over_holes() -> None:
    values = np.sin(TIME_S / 10.0)
    good = np.ones(TIME_S.size, dtype=bool)
    good[500:505] = False
    smooth = moving_average(TIME_S, np.where(good, values, 99.0), good, 1.0)
    assert np.abs(smooth - values)[20:-20].max() < 0.01


@pytest.mark.parametrize(
    ("gain", "said"),
    [
        (0.1450, "psi per kPa"),
        (6.895, "kPa per psi"),
        (14.5, "psi per bar"),
        (0.0690, "bar per psi"),
        (100.5, "kPa per bar"),
    ],
)
def test_a_gain_that_two_units_would_make_is_said_to_be_that(gain: float, said: str) -> None:
    assert f"that is {said}, so one of the two is in another unit" in unit_doubt(gain)
    assert "--units command=UNIT,pressure=UNIT" in unit_doubt(gain)


def test_the_note_of_a_record_says_it() -> None:
    run = record(Toy(), TIME_S, COMMAND)
    assert run.pressure is not None
    notes: list[str] = []
    drive_of(replace(run, pressure=run.pressure / 6.894757), 0.3, notes)
    assert "pressure = 0.1450 x command" in notes[0]
    assert "psi per kPa" in notes[0]


@pytest.mark.parametrize(("gain", "zero"), [(1.0, 0.1), (1.01, 0.0), (0.99, 0.0), (1.02, -0.18)])
def test_a_zero_or_a_gain_that_is_a_little_off_is_said(gain: float, zero: float) -> None:
    """Of the last the middle of the commands agrees; both their ends do not."""
    run = record(Toy(), TIME_S, COMMAND)
    assert run.pressure is not None
    notes: list[str] = []
    stage, _, _ = drive_of(replace(run, pressure=gain * run.pressure + zero), 0.3, notes)
    assert stage is not None
    assert stage.off == pytest.approx(max(abs((gain - 1.0) * end + zero) for end in (4.0, 13.0)), abs=0.01)
    assert f"{gain:.4f} x command"[:5] in notes[0]
    assert "psi off" in notes[0]


def test_a_pressure_that_agrees_within_its_noise_is_not_said_to_be_off() -> None:
    for seed in range(5):
        notes: list[str] = []
        drive_of(record(Toy(), TIME_S[:300], COMMAND[:300], seed=seed, noise_p=0.2), 0.3, notes)
        assert not any("psi off" in note for note in notes)


@pytest.mark.parametrize("gain", [0.95, 1.05, 0.1433, 7.0, -6.895, 0.0])
def test_any_other_gain_is_the_transducers(gain: float) -> None:
    assert "disagree" in unit_doubt(gain)
