"""Rows that are seconds apart hardly show the converter's lag: what is fitted behind it has to say so."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify import identify
from control.identify_model import make_grid
from control.identify_pressure import fit_pressure
from control.identify_track import Track
from logs.recording import FloatArray, Recording
from tests.control.toy_valve import Toy, record, respond, without_pressure

PERIOD_S = 2.0
#: A converter of twice the default's lag, and one of half of it; both are next to nothing after 2 s.
SLOWER, QUICKER = Toy(ep_tau=0.55, tau=1.7, k1=0.21, k2=0.21, rate=0.09), Toy(ep_tau=0.15, tau=3.0)
#: One that the stem alone does not tell from the default.
ALIKE = Toy(ep_tau=0.4, tau=2.34, a1=8.56, a2=6.3)


def stairs(step_psi: float, hold_s: float) -> FloatArray:
    levels = np.concatenate([np.arange(5.0, 12.6, step_psi), np.arange(12.6, 5.0, -step_psi)])
    return np.repeat(levels, round(hold_s / PERIOD_S))


def slow(toy: Toy, step_psi: float, hold_s: float, seed: int) -> Recording:
    command = stairs(step_psi, hold_s)
    return record(toy, PERIOD_S * np.arange(command.size), command, seed=seed)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("toy", [SLOWER, QUICKER])
@pytest.mark.parametrize("measured", [True, False])
def test_taus_interval_holds_it_whatever_the_converters_lag(toy: Toy, seed: int, measured: bool) -> None:
    recording = slow(toy, 0.6, 20.0, seed)
    found = identify([recording if measured else without_pressure(recording)])
    tau, ep = found["tau"].interval, found["ep.tau"].interval
    assert tau is not None and tau.holds(toy.tau)
    assert tau.half_width < 0.15 * toy.tau
    assert ep is None or ep.holds(toy.ep_tau)


def test_steps_of_a_percent_make_no_rate_limit_of_the_converters_lag() -> None:
    found = identify([slow(SLOWER, 0.12, 16.0, 3)])
    assert found["rate_limit"].interval is None  # these steps move the stem at a sixth of it
    assert any("rate limit: never reached" in note for note in found.notes)


def test_what_tau_and_the_lag_add_up_to_is_said_where_neither_is_known_well() -> None:
    found = identify([without_pressure(slow(ALIKE, 0.24, 16.0, 2))])
    (note,) = [note for note in found.notes if note.startswith("tau and the E/P lag add up to")]
    assert "sample faster" in note
    low, high = (float(end) for end in note.partition("(")[2].partition(")")[0].split(" .. "))
    assert low < ALIKE.tau + ALIKE.ep_tau < high
    assert found["tau"].interval is not None and high - low < 2.0 * found["tau"].interval.half_width


def test_a_lag_that_leaves_no_trace_is_given_as_a_range() -> None:
    command = stairs(0.6, 20.0)
    time_s = PERIOD_S * np.arange(command.size)
    pressure = respond(QUICKER, time_s, command)[0] + np.random.default_rng(4).normal(0.0, 0.004, command.size)
    stage = fit_pressure(make_grid(time_s), command, pressure, 0.3)
    assert stage.tau_s is None
    assert stage.lag_s - stage.doubt_s < QUICKER.ep_tau < stage.lag_s + stage.doubt_s <= 0.6
    fast_s = 0.1 * np.arange(3000)
    fast = np.repeat(np.random.default_rng(5).uniform(5.0, 12.0, 100), 30)
    known = respond(QUICKER, fast_s, fast)[0] + np.random.default_rng(6).normal(0.0, 0.004, fast.size)
    assert fit_pressure(make_grid(fast_s), fast, known, 0.3).doubt_s < 0.01


def test_a_track_can_be_driven_by_the_shorter_and_the_longer_lag() -> None:
    grid = make_grid(np.arange(3.0))
    pressure = np.linspace(3.0, 5.0, grid.n_fine)
    track = Track(grid, pressure, np.zeros(3), np.ones(3, dtype=bool), 0.0, later=pressure - 0.5, lag_doubt_s=0.2)
    assert np.allclose(track.lag_moved(1.0).pressure, pressure - 0.5)
    assert np.allclose(track.lag_moved(-1.0).pressure, pressure + 0.5)
    plain = Track(grid, pressure, np.zeros(3), np.ones(3, dtype=bool), 0.0)
    assert plain.lag_moved(1.0) is plain
