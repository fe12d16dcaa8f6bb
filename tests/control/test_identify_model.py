"""The fast simulation against plain Python with ten times finer steps."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify_model import lagged, make_grid, stem
from tests.control.toy_valve import Toy, random_steps, respond

TOY = Toy()
NUMBERS = np.array([TOY.a1, TOY.a2, TOY.k1, TOY.k2, TOY.tau, TOY.rate, TOY.travel])


@pytest.mark.parametrize("period_s", [0.05, 0.1, 0.5])
def test_it_is_exact_to_two_hundredths_of_a_percent_of_travel(period_s: float) -> None:
    time_s = np.arange(0.0, 150.0, period_s)
    command = random_steps(150.0, period_s)[: time_s.size]
    pressure, position = respond(TOY, time_s, command, step_s=0.002)
    grid = make_grid(time_s)
    drive = lagged(grid, command, TOY.ep_tau, float(command[0]))
    found, _ = stem(grid, drive, NUMBERS, 0.0, 0.0)
    assert drive[grid.first] == pytest.approx(pressure, abs=1e-9)
    assert np.abs(found - position).max() < 2e-4 * TOY.travel


def test_intervals_are_cut_evenly_and_rows_keep_their_places() -> None:
    grid = make_grid(np.array([0.0, 0.1, 0.12, 1.0]))
    assert grid.first.tolist() == [0, 4, 5, 41]
    assert grid.fine_time_s[grid.first] == pytest.approx(grid.time_s)
    assert grid.step_s[1:] == pytest.approx([0.025, 0.02, 0.88 / 36])


def test_a_valve_without_lag_or_limits_is_its_play() -> None:
    time_s = np.arange(0.0, 40.0, 0.1)
    p = 9.0 + 3.0 * np.sin(time_s / 3.0)
    grid = make_grid(time_s, 0.1)
    numbers = np.array([8.0, 7.0, 0.1, 0.1, 0.0, 1e9, 1e9])
    x, w = stem(grid, p, numbers, 0.0, 0.0)
    assert x[1:] == pytest.approx(w[1:])
    assert w[200:].max() == pytest.approx(0.1 * (12.0 - 8.0), abs=1e-3)
