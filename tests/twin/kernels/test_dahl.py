"""Dahl's friction before the lag of the stem: held against its closed form and against small Euler steps."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.dahl import dahl_target
from twin.kernels.play import common_start, play_target
from twin.kernels.valve_slots import V_DAHL, V_DAHL_HALF
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, curve_tables

DESIGN = DesignModel()
STOPS = (0.0, DESIGN.travel)
HALF = 0.5 * DESIGN.deadband
EFFECT = effect("distributed_hysteresis")


def plant_with(distance: float, *others: Inserted) -> Plant:
    return Plant(DESIGN, (Inserted(EFFECT.name, EFFECT.form("dahl"), (distance,)), *others))


def target(force: FloatArray, distance: float, w0: float, widening: FloatArray | None = None) -> FloatArray:
    tables = curve_tables(plant_with(distance).coefficients(1.0))
    wide = np.zeros(1) if widening is None else widening
    return dahl_target(force, wide, STOPS, tables, HALF, distance, np.array([w0, np.nan]))


def euler(force: FloatArray, distance: float, w: float, substeps: int = 400) -> FloatArray:
    """offset + w/k + half F = p with dF/dw = (1 - F sgn dw) / distance, each rise of pressure in many small parts."""
    k = DESIGN.compliance
    friction = float(np.clip((force[0] - DESIGN.offset - w / k) / HALF, -1.0, 1.0))
    out = [w]
    for before, after in pairwise(force.tolist()):
        part = (after - before) / substeps
        for _ in range(substeps):
            sign = float(np.sign(part))
            dw = part / (1.0 / k + HALF * (1.0 - sign * friction) / distance)
            w += dw
            friction += sign * (1.0 - sign * friction) * abs(dw) / distance
        out.append(w)
    return np.array(out)


@pytest.mark.parametrize("distance", [0.005, 0.03])
@pytest.mark.parametrize("back", [0.002, 0.01, 0.05])
def test_back_from_a_long_stroke_it_goes_as_in_closed_form(distance: float, back: float) -> None:
    """On the closing curve all friction points one way; back by y the pressure falls by y/k + 2 half (1 - e^(-y/d))."""
    there = np.linspace(4.0, 11.0, 200)
    top = DESIGN.compliance * (11.0 - DESIGN.a1)
    falls = back / DESIGN.compliance + 2.0 * HALF * -np.expm1(-back / distance)
    for steps in (1, 50):
        down = np.linspace(11.0, 11.0 - falls, steps + 1)[1:]
        got = target(np.concatenate([there, down]), distance, 0.0)
        assert got[there.size - 1] == pytest.approx(top, abs=2e-4 + 2.0 * distance * np.exp(-top / distance))
        assert got[-1] == pytest.approx(got[there.size - 1] - back, abs=1e-4)


@settings(deadline=None, max_examples=25)  # the first call compiles
@given(st.lists(st.floats(7.0, 10.5), min_size=2, max_size=6), st.floats(0.01, 0.06))
def test_any_way_it_goes_as_in_small_steps(levels: list[float], distance: float) -> None:
    """Between the stops, from the middle of the travel."""
    start, w0 = DESIGN.offset + 0.28 / DESIGN.compliance, 0.28
    force = np.array([start, *[start + 0.55 * (level - 8.75) for level in levels]])
    got, wanted = target(force, distance, w0), euler(force, distance, w0)
    assert got == pytest.approx(wanted, abs=4e-4)


def test_at_a_stop_it_rests_and_comes_off_it_by_the_other_curve() -> None:
    force = np.concatenate([np.linspace(5.0, 14.0, 300), np.linspace(14.0, 4.0, 300)])
    got = target(force, 0.004, 0.0)
    assert got.min() == 0.0 and got.max() == DESIGN.travel
    back = got[300:]
    # friction has turned after some thousandths of an inch: from there on it follows the opening curve
    middle = (back > 0.1) & (back < 0.5)
    assert back[middle] == pytest.approx(DESIGN.compliance * (force[300:][middle] - DESIGN.a2), abs=2e-3)


def test_from_where_it_was_vented_it_comes_off_the_stop_by_and_by() -> None:
    """Friction still points the other way: offset + w/k + half (1 - 2 e^(-w/d)) = p from the opening curve on."""
    distance = 0.03
    for pressure in (6.5, 8.0, 8.7):
        w = float(target(np.array([4.0, pressure]), distance, 0.0)[-1])
        turned = 1.0 - 2.0 * np.exp(-w / distance)
        assert DESIGN.offset + w / DESIGN.compliance + HALF * turned == pytest.approx(pressure, abs=1e-5)


def test_over_no_distance_it_is_a_play() -> None:
    force = 9.0 + 4.0 * np.sin(np.linspace(0.0, 20.0, 2000)) * np.linspace(1.0, 0.4, 2000)
    c = Plant(DESIGN).coefficients(1.0)
    play = play_target(force, np.zeros(1), STOPS, curve_tables(c), c.spreads, c.weights, 0.2)
    assert target(force, 1e-6, 0.2) == pytest.approx(play, abs=2e-5)


def test_a_deadband_that_grows_is_its_own_too() -> None:
    """By a quarter more on either side: the same as with a design that has it."""
    force = 9.0 + 3.0 * np.sin(np.linspace(0.0, 12.0, 1500))
    wider = DesignModel(a1=DESIGN.a1 + 0.25, a2=DESIGN.a2 - 0.25)
    tables = curve_tables(Plant(wider).coefficients(1.0))
    wanted = dahl_target(force, np.zeros(1), STOPS, tables, HALF + 0.25, 0.02, np.array([0.2, np.nan]))
    assert target(force, 0.02, 0.2, np.array([0.25])) == pytest.approx(wanted, abs=1e-9)
    assert target(force, 0.02, 0.2, np.full(force.size, 0.25)) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("distance", [0.01, 0.04])
def test_the_plays_that_stand_for_it_in_the_force_balance_turn_like_it(distance: float) -> None:
    """After a stroke, while none of a dozen of them is at a stop, they are it, but for their corners."""
    force = np.concatenate([np.linspace(4.0, 10.0, 300), np.linspace(10.0, 7.3, 300)])
    c = plant_with(distance).coefficients(1.0)
    assert c.weights.sum() == pytest.approx(1.0)
    tables = curve_tables(c)
    at = common_start(float(force[0]), 0.0, STOPS, tables, c.spreads, c.weights, 0.0)
    plays = play_target(force, np.zeros(1), STOPS, tables, c.spreads, c.weights, at)[300:]
    exact = target(force, distance, 0.0)[300:]
    assert exact[0] - exact[-1] > 1.5 * distance
    assert plays - plays[0] == pytest.approx(exact - exact[0], abs=0.08 * distance)


def test_no_distance_is_no_effect() -> None:
    c = plant_with(0.0).coefficients(1.0)
    assert c.spreads.size == 1 and not c.valve[[V_DAHL, V_DAHL_HALF]].any()
