"""The output-error fit by itself: no first guess, and only the numbers that the record needs."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify_model import lagged, make_grid
from control.identify_spread import spread_of
from control.identify_track import Track, first_position, thinned
from control.identify_valve import NEVER, Freedom, fit_valve, refit_separate
from tests.control.toy_valve import Toy, random_steps, respond

TIME_S = np.arange(0.0, 240.0, 0.1)
COMMAND = random_steps(240.0, 0.1, seed=5)


def track(toy: Toy, scale: float = 1.0, noise: float = 0.0006) -> Track:
    _, position = respond(toy, TIME_S, COMMAND, step_s=0.01)
    readings = scale * (position + noise * np.random.default_rng(0).standard_normal(TIME_S.size))
    grid = make_grid(TIME_S)
    good = np.ones(TIME_S.size, dtype=bool)
    return Track(grid, lagged(grid, COMMAND, toy.ep_tau, 4.0), readings, good, 0.0)


@pytest.mark.parametrize("scale", [1.0, 177.8, 0.001])
def test_it_needs_no_first_guess_and_no_particular_unit(scale: float) -> None:
    fit, freedom = fit_valve([track(Toy(), scale)])
    assert freedom == Freedom(rate=True, travel=True)
    truth = [8.78, 5.82, 0.19 * scale, 0.19 * scale, 2.7, 0.12 * scale, 0.5625 * scale]
    assert fit.numbers[:7] == pytest.approx(truth, rel=0.005)
    assert fit.ep_tau_s is None  # the pressure was given


@pytest.mark.parametrize(
    ("toy", "freedom"),
    [
        (Toy(rate=1e6), Freedom(rate=False, travel=True)),
        (Toy(travel=1e6), Freedom(rate=True, travel=False)),
        (Toy(rate=1e6, travel=1e6), Freedom(rate=False, travel=False)),
    ],
)
def test_limits_that_play_no_part_are_left_out(toy: Toy, freedom: Freedom) -> None:
    fit, found = fit_valve([track(toy)])
    assert found == freedom
    assert (fit.numbers[5] == NEVER, fit.numbers[6] == NEVER) == (not freedom.rate, not freedom.travel)
    assert fit.numbers[:5] == pytest.approx([8.78, 5.82, 0.19, 0.19, 2.7], rel=0.01)


def test_packing_and_unpacking_are_each_others_inverse() -> None:
    numbers = np.array([8.0, 6.0, 0.2, 0.2, 3.0, 0.1, 0.5, 0.3])
    for freedom in (Freedom(True, True, ep=True), Freedom(True, True, separate=True, ep=True)):
        assert freedom.unpack(freedom.pack(numbers)) == pytest.approx(numbers)
        assert len(freedom.names) == freedom.pack(numbers).size


def test_pressure_noise_widens_what_it_moves() -> None:
    plain = track(Toy())
    wave = 0.01 * np.sin(plain.grid.fine_time_s)
    doubtful = Track(plain.grid, plain.pressure, plain.position, plain.good, plain.start, (wave, -wave))
    fit, freedom = fit_valve([plain])
    narrow, wide = spread_of([plain], fit, freedom)[0], spread_of([doubtful], fit, freedom)[0]
    assert (np.diag(wide) >= np.diag(narrow)).all()
    assert wide[0, 0] > 10.0 * narrow[0, 0]
    assert refit_separate([plain], fit, freedom)[1].separate


def test_a_record_that_begins_in_motion_begins_where_it_is() -> None:
    chance = np.random.default_rng(2)
    moving = 0.2 + 0.12 * TIME_S[:50] + 0.0006 * chance.standard_normal(50)
    assert first_position(TIME_S[:50], moving, np.ones(50, dtype=bool)) == pytest.approx(0.2, abs=0.002)
    still = 0.2 + 0.0006 * chance.standard_normal(50)
    assert first_position(TIME_S[:50], still, np.ones(50, dtype=bool)) == pytest.approx(0.2, abs=0.001)


def test_thinning_keeps_the_signal() -> None:
    plain = track(Toy(), noise=0.0)
    rough = thinned(plain)
    assert rough.position.size == plain.position.size // 2
    assert rough.position == pytest.approx(plain.position[::2])


@pytest.mark.parametrize(("period", "phase"), [(2, 1), (2, 0), (4, 3), (10, 7)])
def test_thinning_keeps_the_readings_of_a_position_that_is_polled_less_often(period: int, phase: int) -> None:
    plain = track(Toy())
    plain.good[:] = False
    plain.good[phase::period] = True
    rough = thinned(plain)
    assert rough.good.sum() == TIME_S.size // period


def test_thinning_leaves_rows_of_a_record_that_is_over_at_once() -> None:
    plain = track(Toy())
    grid = make_grid(1e-4 * TIME_S)
    assert thinned(Track(grid, np.zeros(grid.n_fine), plain.position, plain.good, 0.0)).position.size >= 30
