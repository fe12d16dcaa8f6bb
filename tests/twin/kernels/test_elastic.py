"""Friction that turns over a distance: against a plain integration in small steps, and against its limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.loops import advanced
from tests.twin.springs import LONG, PRESSURE, START, TIME_S, plant, stem, stem_from, stepped
from twin.kernels.elastic import SPRINGS, stretches
from twin.kernels.valve_slots import V_PRESLIDING, V_TAU_AFTER_S
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid


@pytest.mark.parametrize("reach", [0.005, pytest.param(0.06, marks=pytest.mark.thorough)])
def test_like_springs_stepped_in_small_steps(reach: float) -> None:
    """Other formulation, same valve; started as after opening."""
    assert np.max(np.abs(stem(plant(reach)) - stepped(reach))) < 0.001 * 0.5625


@pytest.mark.parametrize(
    "share", [pytest.param(0.1, marks=pytest.mark.thorough), 0.6, pytest.param(1.0, marks=pytest.mark.thorough)]
)
def test_behind_a_play_it_is_like_springs_stepped_behind_one(share: float) -> None:
    """What of the deadband is no friction on the stem is a play before it."""
    form = effect("friction_in_motion").form("partial_elastic")
    got = stem(Plant(LONG, [Inserted("friction_in_motion", form, (share, 0.02, 0.0, 0.0))]))
    assert np.max(np.abs(got - stepped(0.02, share=share))) < 0.001 * 0.5625


def test_all_of_the_friction_behind_no_play_is_the_elastic_form() -> None:
    """Its soft stops, too."""
    effects = effect("friction_in_motion")
    whole, part = (
        stem(Plant(DesignModel(), [Inserted(effects.name, effects.form(name), values)]))
        for name, values in (("elastic", (0.02, 0.03, 0.05)), ("partial_elastic", (1.0, 0.02, 0.03, 0.05)))
    )
    rigid = stem(Plant(DesignModel(), [Inserted(effects.name, effects.form("elastic"), (0.02, 0.0, 0.0))]))
    np.testing.assert_allclose(part, whole, atol=1e-12)
    assert np.max(np.abs(whole - rigid)) > 0.002


@pytest.mark.thorough
@pytest.mark.parametrize(("form", "power"), [("falling_with_speed", 1), ("falling_with_speed_squared", 2)])
def test_it_falls_with_the_speed_as_in_small_steps(form: str, power: int) -> None:
    """A stem whose friction grows as it slows down stops short; the springs hold it there."""
    falling = (0.15, 0.03)
    got, even = stem(plant(0.005, falling=falling, form=form)), stem(plant(0.005))
    assert np.max(np.abs(got - stepped(0.005, falling, power=power))) < 0.001 * 0.5625
    assert np.max(np.abs(got - stepped(0.005, falling, power=3 - power))) > 0.002 * 0.5625
    assert np.max(np.abs(got - even)) > 0.01 * 0.5625


@pytest.mark.parametrize("form", ["falling_with_speed", "falling_with_speed_squared"])
def test_short_springs_that_let_go_with_the_speed_are_such_friction(form: str) -> None:
    """The other loop knows the same two laws."""
    falling = Inserted("stiction", effect("stiction").form(form), (0.15, 0.03))
    full = Plant(LONG, [Inserted("friction_in_motion", effect("friction_in_motion").form("full"), ()), falling])
    assert np.max(np.abs(stem(plant(1e-6, falling=(0.15, 0.03), form=form)) - stem(full))) < 0.002 * 0.5625


def test_short_springs_are_friction_in_motion() -> None:
    """The limit of no distance is friction that turns at once."""
    full = Plant(LONG, [Inserted("friction_in_motion", effect("friction_in_motion").form("full"), ())])
    assert np.max(np.abs(stem(plant(1e-6)) - stem(full))) < 0.002 * 0.5625
    assert np.max(np.abs(stem(plant(0.06)) - stem(full))) > 0.03 * 0.5625


def test_slowly_it_is_the_spread_of_plays_that_it_makes() -> None:
    """With all the time in the world, springs in the force balance and plays before it give one curve."""
    slow = TIME_S * 5000.0
    inside, before = stem(plant(0.06), slow, step_s=20.0), stem(plant(0.06, in_motion=False), slow, step_s=20.0)
    after = TIME_S > 14.0
    assert np.max(np.abs(inside - before)[after]) < 0.002 * 0.5625


def test_it_is_quick_while_springs_hold() -> None:
    """After a reversal the stem settles within a fraction of its lag: what holds it is stiff."""
    time_s = np.arange(0.0, 40.0, 0.05)
    pressure = np.where(time_s < 25.0, 13.5, 12.6)
    x = stem(plant(0.06), time_s, pressure)
    after = time_s > 25.0
    moved = (x - x[time_s <= 25.0][-1])[after]
    settled = moved[-1]
    assert settled < -0.002
    slow = DesignModel().tau_s
    reached = time_s[after][np.argmax(moved < 0.63 * settled)] - 25.0
    assert reached < 0.5 * slow


def test_what_begins_at_rest_stays() -> None:
    """Springs hold the stem where it is first read, between the curves."""
    time_s = np.arange(0.0, 20.0, 0.1)
    grid = make_grid(time_s, 0.02)
    for x0 in (0.05, 0.2, 0.3):
        pressure = np.full(grid.n_fine, 7.3 + x0 / DesignModel().compliance + 0.4)
        got = stem_response(plant(0.06).coefficients(20.0), grid, pressure, x0, x0)
        assert np.max(np.abs(got - x0)) < 1e-4


@pytest.mark.parametrize("falling", [None, (0.15, 0.01)])
@pytest.mark.parametrize("change", [lambda c: None, lambda c: c.valve.__setitem__(V_TAU_AFTER_S, 0.2)])
def test_row_by_row_it_is_the_same(change: Callable[[object], None], falling: tuple[float, float] | None) -> None:
    """The live twin carries the springs from row to row, and so does the other loop beside what only that one knows."""
    c = plant(0.06, falling=falling).coefficients(60.0)
    change(c)
    assert c.valve[V_PRESLIDING] == 0.06
    grid = make_grid(TIME_S, 0.02)
    fine = np.interp(np.interp(np.arange(grid.n_fine), grid.offsets, TIME_S), TIME_S, PRESSURE)
    want = stem_response(c, grid, fine, START, START)
    assert np.allclose(advanced(c, TIME_S, PRESSURE, START), want[grid.offsets], atol=1e-9)


def test_there_are_many_short_springs_and_few_long_ones() -> None:
    slips = stretches(0.1)
    assert slips.size == SPRINGS and np.all(np.diff(np.diff(slips)) > 0.0) and slips[-1] < 0.1


def test_coarse_steps_give_the_same_stem() -> None:
    """Springs are stiff against the lag; what they hold is stepped exactly."""
    assert np.max(np.abs(stem(plant(0.06), step_s=0.05) - stem(plant(0.06), step_s=0.005))) < 0.0003 * 0.5625
    rows = slice(None, None, 10)
    coarse = stem(plant(0.06), TIME_S[rows], PRESSURE[rows], step_s=0.5)
    assert np.max(np.abs(coarse - stem(plant(0.06))[rows])) < 0.02 * 0.5625


@pytest.mark.parametrize("reach", [0.001, 0.06])
def test_stops_hold_the_stem_and_not_what_pulls_it(reach: float) -> None:
    """Forces that would balance beyond a stop: the stem meets it at speed, and stays within."""
    soft = Inserted("friction_in_motion", effect("friction_in_motion").form("elastic"), (reach, 0.05, 0.05))
    rigid = Inserted("friction_in_motion", soft.form, (reach, 0.0, 0.0))
    pressure = np.interp(TIME_S, [0, 10, 30, 35, 60], [4.0, 13.0, 13.0, 4.0, 4.0])
    met, crept = (stem_from(Plant(DesignModel(), (one,)), pressure, 0.0) for one in (soft, rigid))
    assert met.min() == 0.0 and met.max() == DesignModel().travel
    arrival = TIME_S[np.argmax(met >= DesignModel().travel)]
    assert arrival < 30.0 and crept[arrival + 0.1 > TIME_S].max() < DesignModel().travel - 0.002


def test_a_fault_adds_to_the_distance_that_the_design_has() -> None:
    own = Inserted("friction_in_motion", effect("friction_in_motion").form("elastic"), (0.01, 0.0, 0.0))
    fault = Inserted("distributed_hysteresis", effect("distributed_hysteresis").form("turns_over_a_distance"), (0.03,))
    assert Plant(DesignModel(), (own, fault)).coefficients(9.0).valve[V_PRESLIDING] == pytest.approx(0.04)


def test_a_stem_that_springs_still_hold_stops_at_its_stop() -> None:
    """It is pulled beyond the stop before its springs have turned: the way there ends at the stop."""
    d, soft = (
        DesignModel(),
        Inserted("friction_in_motion", effect("friction_in_motion").form("elastic"), (0.3, 0.05, 0.05)),
    )
    x0 = d.travel - 0.001
    grid = make_grid(TIME_S, 0.02)
    pressure = np.where(np.arange(grid.n_fine) < 50, d.a2 + x0 / d.compliance, d.a1 + d.travel / d.compliance + 2.0)
    x = stem_response(Plant(d, (soft,)).coefficients(60.0), grid, pressure, x0, x0)
    assert x.max() == d.travel and x[-1] == d.travel
