"""The fine grid: every row is a fine point, no step is longer than asked for, gaps stay affordable."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from twin.timegrid import make_grid


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
