"""A booster of limited flow into a chamber that the stem changes: against plain small steps, and against its limits."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import inf, isfinite, sqrt

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from logs.units import atmosphere
from tests.twin.judged import a_record
from twin.diagnose import Settings, diagnose
from twin.fit.channel import Channel, chain_channel, predict_pressure, pressure_channel
from twin.fit.trial import make_trial
from twin.kernels.booster import outflow
from twin.kernels.ep import ep_kernel
from twin.kernels.ep_slots import EP_TAU_FALL_S, EP_TAU_RISE_S
from twin.live.twin import LiveTwin
from twin.model.catalog import effect
from twin.model.coefficients import Coefficients
from twin.model.plant import Inserted, Plant, pressure_response
from twin.model.timegrid import make_grid
from twin.replay.chain import chain_response
from twin.replay.simulate import Start, simulate_recording
from twin.search.candidates import effect_causes
from twin.search.search_rules import SearchRules

D = DesignModel()
TIME_S = np.arange(0.0, 80.05, 0.1)
#: Steps far and near, up and down, a ramp, and one down to no pressure.
COMMAND = np.select(
    [TIME_S <= 5, TIME_S <= 20, TIME_S <= 30, TIME_S <= 32, TIME_S <= 60, TIME_S <= 70],
    [6.0, 14.0, 9.0, 9.05, 9.05 - 0.1 * (TIME_S - 32.0), 13.0],
    0.0,
)
#: A stem that closes and opens again while the command stands still, too.
STEM = np.interp(TIME_S, [0, 6, 12, 22, 40, 45, 80], [0.0, 0.0, 0.5, 0.1, 0.1, 0.4, 0.0])
WIDE = 0.034 * D.travel / D.compliance


def plant(up_s: float, down_s: float, air: float) -> Plant:
    """The thesis's valve behind such a converter, whose slownesses are those with the stem open."""
    half_way = tuple(slow_s * (1.0 + 0.5 * air) for slow_s in (up_s, down_s))
    return Plant(D, (Inserted("ep_rate_limit", effect("ep_rate_limit").form("orifices"), (*half_way, air)),))


def pressure(one: Plant, stem: FloatArray | None = STEM, step_s: float = 0.02) -> FloatArray:
    """At the rows."""
    grid = make_grid(TIME_S, step_s)
    fine = None if stem is None else np.interp(grid.fine_time_s, TIME_S, stem)
    return pressure_response(one.coefficients(80.0), grid, COMMAND, 6.0, fine)[grid.offsets]


def stepped(up_s: float, down_s: float, air: float, supply: float = inf, per: int = 300) -> FloatArray:
    """The same by explicit steps of a third of a millisecond, from the balance of air; `supply`: over 20.3 psi, choked
    all the way."""
    p, v, rows, ambient, at_rest = 6.0, 6.0, [6.0], 14.696, _out(D.offset)
    row_s = np.diff(TIME_S).tolist()
    for (x0, x1), u, long_s in zip(pairwise(STEM.tolist()), COMMAND[1:].tolist(), row_s, strict=True):
        h, speed = long_s / per, (x1 - x0) / long_s
        for k in range(per):
            v += h * (u - v) / D.ep_tau_s
            opening = min(max((v - p) / WIDE, -1.0), 1.0)
            flow = opening / up_s * _in(p, supply) if opening > 0 else opening / down_s * _out(p) / at_rest
            x = x0 + (k + 0.5) * h * speed
            p += h * (flow - air / D.travel * (p + ambient) * speed) / (1.0 + air / D.travel * x)
            p = min(p, supply)  # what a stem that opens presses together beyond it flows back
        rows.append(p)
    return np.array(rows)


def _out(p: float) -> float:
    """ISO 6358-1 with a critical ratio of a half: elliptic below it."""
    ratio = 14.696 / (p + 14.696)
    return (p + 14.696) * sqrt(1.0 - max(0.0, (ratio - 0.5) / 0.5) ** 2) if p > 0 else 0.0


def _in(p: float, supply: float) -> float:
    """The same from a supply, over what a usual one of 1.38 atmospheres gives while it is choked."""
    if not isfinite(supply):
        return 1.0
    ratio = (p + 14.696) / (supply + 14.696)
    choked = (supply + 14.696) / (1.38 * 14.696 + 14.696)
    return choked * sqrt(max(0.0, 1.0 - max(0.0, (ratio - 0.5) / 0.5) ** 2)) if ratio < 1.0 else 0.0


@pytest.mark.parametrize("values", [(0.05, 0.08, 1.5), (0.3, 0.2, 0.6)])
@pytest.mark.parametrize("supply", [pytest.param(9.5, marks=pytest.mark.thorough), 12.0])
def test_a_weak_supply_fills_more_and_more_slowly(values: tuple[float, float, float], supply: float) -> None:
    booster = plant(*values)
    weak = Inserted("supply_saturation", effect("supply_saturation").form("cut_off"), (supply,))
    found = pressure(replace(booster, inserted=(*booster.inserted, weak)), step_s=0.005)
    assert np.max(np.abs(found - stepped(*values, supply=supply))) < 0.02


@pytest.mark.parametrize("values", [(0.3, 0.5, 0.0), (0.1, 0.15, 1.5), (1.0, 0.6, 3.0)])
def test_like_the_balance_of_air_in_small_steps(values: tuple[float, float, float]) -> None:
    assert np.max(np.abs(pressure(plant(*values)) - stepped(*values))) < 0.01


def test_with_all_the_flow_there_is_it_is_the_pilot() -> None:
    assert np.max(np.abs(pressure(plant(1e-4, 1e-4, 2.0)) - pressure(Plant(D)))) < 0.01


def test_a_stem_that_closes_takes_air() -> None:
    """The pressure sags while it moves and the command stands, the more the less can flow."""
    alone, taken = pressure(plant(0.3, 0.3, 1.5), None), pressure(plant(0.3, 0.3, 1.5))
    moving = (TIME_S > 41.0) & (TIME_S < 45.0)
    assert np.max((taken - alone)[moving]) < -0.03
    freer = (pressure(plant(0.1, 0.1, 1.5)) - pressure(plant(0.1, 0.1, 1.5), None))[moving]
    assert np.mean(freer) > 0.6 * np.mean((taken - alone)[moving])


def test_coarse_steps_give_the_same_pressure() -> None:
    fine, coarse = (pressure(plant(0.1, 0.2, 1.5), step_s=step_s) for step_s in (0.002, 0.02))
    assert np.max(np.abs(fine - coarse)) < 0.02


def test_air_leaves_through_an_opening_as_the_standard_says() -> None:
    """Choked up to half of the pressure: in proportion to the absolute pressure; none without a difference."""
    assert outflow(20.0, 14.7) == pytest.approx(34.7)
    assert outflow(0.0, 14.7) == outflow(-1.0, 14.7) == 0.0
    assert outflow(5.0, 14.7) == pytest.approx(19.7 * np.sqrt(1.0 - ((14.7 / 19.7 - 0.5) / 0.5) ** 2))


def test_the_atmosphere_in_units() -> None:
    assert atmosphere("psi") == (14.696, 0.0)
    assert atmosphere("kPa")[0] == pytest.approx(101.325, abs=0.01)
    absolute, reading = atmosphere("percent")
    assert 3.0 + 0.12 * reading == 0.0 and 0.12 * absolute == pytest.approx(14.696)


def test_converter_and_stem_agree() -> None:
    """What the stem does to the pressure, and the pressure to the stem, is one answer, whatever the rows."""
    one, grid = plant(0.3, 0.4, 1.5), make_grid(TIME_S, 0.02)
    c = one.coefficients(80.0)
    p, x = chain_response(c, grid, COMMAND, 6.0, 0.0, 0.0)
    assert np.max(np.abs(pressure_response(c, grid, COMMAND, 6.0, x) - p)) < 0.02
    assert np.max(np.abs(pressure_response(c, grid, COMMAND, 6.0) - p)) > 0.5
    rows = slice(None, None, 5)
    changes = np.searchsorted(TIME_S[rows], TIME_S)  # rows that are told apart by steps of the command only
    often = chain_response(c, grid, COMMAND[rows][changes], 6.0, 0.0, 0.0)[1][grid.offsets][rows]
    rare = make_grid(TIME_S[rows], 0.02)
    seldom = chain_response(c, rare, COMMAND[rows], 6.0, 0.0, 0.0)[1][rare.offsets]
    assert np.max(np.abs(often - seldom)) < 0.0005


def test_a_trial_takes_the_stem_as_it_was_read() -> None:
    one = plant(0.3, 0.4, 1.5)
    blank = Recording("r", TIME_S, COMMAND, np.zeros(TIME_S.size), None)
    p, y = simulate_recording(one, blank, start=Start(6.0, 0.0, 0.0))
    noisy = y + 0.0003 * np.random.default_rng(1).standard_normal(y.size)
    trial = make_trial(Recording("r", TIME_S, COMMAND, noisy, p), 0.02)
    missed = predict_pressure(one, trial) - p
    assert np.sqrt(np.mean(missed**2)) < 0.01
    assert np.ptp(predict_pressure(one, replace(trial, stem=None)) - p) > 0.1
    false = np.zeros(y.size, dtype=np.bool_)
    false[[200, 201, 410]] = True
    sick = make_trial(Recording("r", TIME_S, COMMAND, np.where(false, 0.9, noisy), p), 0.02, false)
    assert sick.stem is not None and trial.stem is not None
    assert np.max(np.abs(sick.stem - trial.stem)) < 0.01
    assert make_trial(blank, 0.02).stem is None


def test_it_is_tried_where_the_pressure_was_measured() -> None:
    trial = make_trial(Recording("r", TIME_S, COMMAND, STEM, COMMAND), 0.05)
    chain = replace(trial, recording=Recording("r", TIME_S, COMMAND, STEM, None))

    def forms(channel: Channel) -> set[str]:
        causes = [c for c in effect_causes(channel) if c.name == "ep_rate_limit"]
        return {c.form.name for c in causes if c.form is not None}

    assert forms(pressure_channel([trial], 0.01)) == {"symmetric", "up_and_down", "ramped", "orifices", "stroke"}
    assert forms(chain_channel([chain], 0.01)) == {"symmetric", "up_and_down", "ramped"}


@pytest.mark.parametrize(("values", "tolerance"), [((0.3, 0.4, 1.5), 1e-9), ((0.3, 0.4, 0.05), 0.02)])
def test_row_by_row_it_is_the_same(values: tuple[float, float, float], tolerance: float) -> None:
    """A live model goes block by block; so does a replay where much air is taken, and nearly agrees with it if not."""
    one, grid = plant(*values), make_grid(TIME_S, 0.02)
    want, _ = chain_response(one.coefficients(80.0), grid, COMMAND, 6.0, 0.0, 0.0)
    live = LiveTwin(one, 0.0, COMMAND[0], Start(6.0, 0.0, 0.0), 80.0, 0.02)
    got = [6.0, *(live.step(t, u)[0] for t, u in zip(TIME_S[1:], COMMAND[1:], strict=True))]
    assert np.max(np.abs(np.array(got) - want[grid.offsets])) < tolerance


@pytest.mark.parametrize(("dirt", "up", "down"), [(1.5, 1.0, 2.5), (-0.8, 1.8, 1.0)])
def test_dirt_in_a_port_lets_less_through_it(dirt: float, up: float, down: float) -> None:
    port = Inserted("fill_exhaust_asymmetry", effect("fill_exhaust_asymmetry").form("port"), (dirt,))
    clean = plant(0.1, 0.15, 2.0)
    want = pressure(plant(0.1 * up, 0.15 * down, 2.0))
    np.testing.assert_allclose(pressure(clean.having((port,))), want, atol=1e-12)
    np.testing.assert_allclose(pressure(Plant(D, (port, *clean.inserted))), want, atol=1e-12)
    assert np.abs(pressure(clean) - want).max() > 0.3
    lags = Coefficients(D, 80.0)
    lags.ep[[EP_TAU_RISE_S, EP_TAU_FALL_S]] = D.ep_tau_s * np.array([up, down])
    grid = make_grid(TIME_S, 0.02)
    plain = np.empty(grid.n_fine)
    ep_kernel(grid.time_s, COMMAND, grid.offsets, lags.ep, 6.0, None, plain)
    np.testing.assert_allclose(pressure(Plant(D, (port,)), None), plain[grid.offsets], atol=1e-12)


@pytest.mark.parametrize("air", [0.5, 4.0])
def test_the_slopes_are_those_with_the_stem_half_way(air: float) -> None:
    """More air through wider openings is all but the same there: slownesses of the open stem leave fits a valley."""
    form = effect("ep_rate_limit").form("orifices")
    filled = pressure(Plant(D, (Inserted("ep_rate_limit", form, (0.5, 0.5, air)),)), np.full_like(STEM, 0.5 * D.travel))
    slope = np.max(np.gradient(filled, TIME_S))
    assert slope == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("dirt", [4.0, pytest.param(-4.0, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("clean", [0.0, 0.1])
def test_a_dirty_port_shows_the_chamber_and_the_supply(dirt: float, clean: float) -> None:
    """That a narrow supply port fills as ISO 6358 says, up to the supply, and that more or less air is swept.

    With the stem half way the chamber is 2.25 times as large, then 1.75 times, with the same slopes.
    """
    form = effect("fill_exhaust_asymmetry").form("port_and_chamber")
    port = Inserted("fill_exhaust_asymmetry", form, (dirt, -0.4, clean))
    known, by, other = plant(0.1, 0.15, 2.5), 1.0 + abs(dirt), 1.0 + clean * abs(dirt)
    up, down, supply = (0.1 * other, 0.15 * by, np.inf) if dirt > 0.0 else (0.1 * by, 0.15 * other, 1.38 * 14.696)
    if clean > 0.0:
        supply = 1.38 * 14.696
    found = pressure(known.having((port,)), step_s=0.005)
    assert np.max(np.abs(found - stepped(up * 2.25 / 1.75, down * 2.25 / 1.75, 1.5, supply))) < 0.02
    np.testing.assert_allclose(pressure(Plant(D, (port, *known.inserted)), step_s=0.005), found, atol=1e-12)


@pytest.mark.thorough
def test_a_dirty_port_of_a_known_booster_is_named() -> None:
    known = plant(0.1, 0.15, 2.0)
    port = Inserted("fill_exhaust_asymmetry", effect("fill_exhaust_asymmetry").form("port"), (1.5,))
    record = a_record(known.having((port,)), seed=5)
    found = diagnose([record], D, known.inserted, Settings(search=SearchRules(most=2))).diagnosis
    [cause] = found.causes  # in a form with a port; what its chamber adds is next to nothing
    assert cause.name == "fill_exhaust_asymmetry"
    assert cause.form in ("port", "port_and_chamber")
    assert cause.parameters["dirt"].value == pytest.approx(1.5, rel=0.05)
