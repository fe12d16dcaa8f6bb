"""The fine grid: every row is a fine point, no step is longer than asked for, gaps stay affordable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import Recording
from twin.fit.channel import predict_reading
from twin.fit.trial import make_trial
from twin.model.plant import Plant
from twin.model.timegrid import FINER, make_grid
from twin.replay.simulate import Start, simulate_recording

DESIGN = DesignModel()


@given(st.lists(st.floats(0.001, 3.0), min_size=1, max_size=40), st.floats(0.005, 1.0))
def test_rows_are_fine_points_and_steps_are_short(steps: list[float], step_s: float) -> None:
    time_s = np.concatenate([[5.0], 5.0 + np.cumsum(steps)])
    grid = make_grid(time_s, step_s)
    fine = grid.fine_time_s
    assert fine.size == grid.n_fine
    np.testing.assert_allclose(fine[grid.offsets], time_s)
    assert np.diff(fine).max() <= step_s * (1.0 + 1e-6)


def test_an_interval_that_fits_is_not_cut() -> None:
    grid = make_grid(np.arange(50) * 0.1, 0.1)
    assert grid.n_fine == 50


def test_a_gap_of_a_day_does_not_cost_millions_of_steps() -> None:
    assert make_grid(np.array([0.0, 0.1, 86_400.0]), 0.02).n_fine == 5 + 10_000 + 1


def test_steps_are_shorter_behind_a_jump_of_the_command() -> None:
    time_s, command = np.arange(200) * 0.1, np.repeat([3.0, 15.0, 14.9], [50, 100, 50])
    steps = np.diff(make_grid(time_s, 0.05, command).offsets)
    assert np.flatnonzero(steps > 2).tolist() == list(range(49, 54)), "from the row before the jump on, for 0.5 s"
    assert set(steps[49:54]) == {2 * FINER}
    longer = np.diff(make_grid(time_s, 0.05, command, quick_s=1.0).offsets)
    assert np.flatnonzero(longer > 2).tolist() == list(range(49, 59))


def test_a_command_that_jumps_all_the_time_has_no_jumps() -> None:
    command = np.random.default_rng(1).uniform(3.0, 15.0, 200)
    grid = make_grid(np.arange(200) * 0.1, 0.05, command)
    np.testing.assert_array_equal(grid.offsets, make_grid(np.arange(200) * 0.1, 0.05).offsets)
    still = make_grid(np.arange(200) * 0.1, 0.05, np.full(200, 9.0))
    np.testing.assert_array_equal(still.offsets, grid.offsets)


@given(st.lists(st.tuples(st.floats(0.01, 3.0), st.floats(3.0, 15.0)), min_size=1, max_size=40), st.floats(0.005, 1.0))
def test_jumps_only_make_steps_shorter(rows: list[tuple[float, float]], step_s: float) -> None:
    time_s = np.concatenate([[5.0], 5.0 + np.cumsum([step for step, _ in rows])])
    command = np.array([9.0, *(level for _, level in rows)])
    grid, plain = make_grid(time_s, step_s, command), make_grid(time_s, step_s)
    assert np.all(np.diff(grid.offsets) >= np.diff(plain.offsets))
    np.testing.assert_allclose(grid.fine_time_s[grid.offsets], time_s)
    assert 0.0 < plain.typical_s <= step_s * (1.0 + 1e-6)


def test_what_steps_miss_of_full_strokes_is_far_below_a_quiet_gauges_noise() -> None:
    """In steps of 0.05 s alone 0.02 % of travel, RMS: by 0.6 times a noise of 0.04 % a healthy valve differs then."""
    command = np.repeat([3.0, 15.0, 4.0, 14.5, 3.5, 15.0], 200)
    blank = Recording("strokes", 0.1 * np.arange(command.size), command, np.zeros(command.size))
    truth = simulate_recording(DESIGN, blank, 0.001, Start(3.0, 0.0, 0.0))[1]
    recording = replace(blank, position=truth)
    plain = replace(make_trial(recording, 0.05), grid=make_grid(recording.time_s, 0.05))
    missed = [
        float(np.sqrt(np.mean((predict_reading(Plant(DESIGN), trial) - truth) ** 2))) / DESIGN.travel
        for trial in (make_trial(recording, 0.05), plain)
    ]
    assert missed[0] < 1e-4
    assert missed[1] > 2.5 * missed[0]
