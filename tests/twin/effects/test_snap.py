"""A spring that gives way faster than it stiffens: the curve folds, and the stem jumps over the fold."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.judged import UP_TO_TWO, a_record
from twin.choose.stages import driven_about
from twin.diagnose import diagnose
from twin.fit.case import make_case
from twin.fit.channel import position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, curve_tables, stem_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel()
SPAN = DESIGN.travel / DESIGN.compliance
DROP, CENTRE, STEEP = 0.7, 0.5, 2.0
WIDTH = DROP / (STEEP * SPAN)


def snapping(form: str) -> Plant:
    spring = effect("nonlinear_spring")
    return Plant(DESIGN, (Inserted(spring.name, spring.form(form), (DROP, CENTRE, STEEP - 1.1)),))


def spring_psi(xi: FloatArray) -> FloatArray:
    """Pressure that the spring asks for, of a logistic fall."""
    return np.asarray(SPAN * xi - DROP / (1.0 + np.exp(-4.0 * (xi - CENTRE) / WIDTH)))


def folds() -> tuple[float, float]:
    """Where its curve turns: at the top of the fold and at its foot, fractions of travel."""

    def slope(xi: float) -> float:
        part = 1.0 / (1.0 + np.exp(-4.0 * (xi - CENTRE) / WIDTH))
        return float(SPAN - DROP * part * (1.0 - part) * 4.0 / WIDTH)

    return brentq(slope, CENTRE - 3.0 * WIDTH, CENTRE), brentq(slope, CENTRE, CENTRE + 3.0 * WIDTH)


def at(curve: FloatArray, first: float, step: float, pressure_psi: float) -> float:
    return float(np.interp(pressure_psi, first + step * np.arange(curve.size), curve))


def test_the_stem_jumps_up_at_the_top_of_the_fold_and_down_at_its_foot() -> None:
    first, step, closing, opening = curve_tables(snapping("snaps").coefficients(1.0))
    top, foot = folds()
    up = DESIGN.a1 + float(spring_psi(np.array(top)))
    down = DESIGN.a2 + float(spring_psi(np.array(foot)))
    margin_psi = 0.02
    assert at(closing, first, step, up - margin_psi) < top * DESIGN.travel
    beyond = brentq(lambda xi: DESIGN.a1 + float(spring_psi(np.array(xi))) - up - margin_psi, foot, 1.5)
    assert at(closing, first, step, up + margin_psi) == pytest.approx(beyond * DESIGN.travel, abs=0.01)
    assert at(opening, first, step, down + margin_psi) > foot * DESIGN.travel
    before = brentq(lambda xi: DESIGN.a2 + float(spring_psi(np.array(xi))) - down + margin_psi, -0.5, top)
    assert at(opening, first, step, down - margin_psi) == pytest.approx(before * DESIGN.travel, abs=0.01)


@pytest.mark.parametrize("closes", [True, False])
def test_where_the_stem_is_decides_against_small_steps(closes: bool) -> None:
    """A ramp of the pressure over the fold; the stem follows its own law in steps of a millisecond."""
    dt_s, start_psi, ramp_psi_s = 0.001, (DESIGN.a1 if closes else DESIGN.a2 + SPAN), 0.15 if closes else -0.15
    time_s = np.arange(0.0, 30.0, 0.05)
    grid = make_grid(time_s, 0.02)
    fine_s = np.interp(np.arange(grid.n_fine), grid.offsets, time_s)
    x0 = 0.0 if closes else DESIGN.travel
    plant = snapping("stem_snaps")
    stem = stem_response(plant.coefficients(30.0), grid, start_psi + ramp_psi_s * fine_s, x0, x0)[grid.offsets]
    x, friction_psi, want = x0, DESIGN.a1 if closes else DESIGN.a2, []
    for k in range(round(time_s[-1] / dt_s) + 1):
        if k % round(0.05 / dt_s) == 0:
            want.append(x)
        gives_psi = DROP / (1.0 + np.exp(-4.0 * (x / DESIGN.travel - CENTRE) / WIDTH))
        target = DESIGN.compliance * (start_psi + ramp_psi_s * k * dt_s - friction_psi + gives_psi)
        pulled_to = min(max(target, 0.0), DESIGN.travel)
        x += dt_s * np.clip((pulled_to - x) / DESIGN.tau_s, -DESIGN.rate_limit, DESIGN.rate_limit)
    assert np.ptp(stem) > 0.9 * DESIGN.travel
    assert np.max(np.abs(stem - np.array(want))) < 0.01 * DESIGN.travel


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["snaps", "stem_snaps"])
def test_folds_drawn_at_random_are_found(form: str) -> None:
    """The response jumps with place and depth; a fit that went by slopes alone would stop beside it."""
    spring, dice, left = effect("nonlinear_spring"), np.random.default_rng(3), []
    for number in range(12):
        fold = (dice.uniform(0.2, 1.2), dice.uniform(0.2, 0.8), dice.uniform(0.1, 3.9))
        record = a_record(Plant(DESIGN, (Inserted(spring.name, spring.form(form), fold),)), seed=number)
        case = make_case([record], DESIGN)
        channel = position_channel(driven_about(case.base, case), case.sigma_y)
        space = make_space(case.base, (Cause(spring.name, spring, spring.form(form)),), channel.numbers, case.scales)
        rough = fit(channel, space, starts_of(space, [], [record]), rounds=6)
        left.append(fit(channel, space, [rough.z]).mse)
    assert sum(mse < 1.5 for mse in left) >= 10, np.round(left, 2)


@pytest.mark.thorough
def test_a_spring_that_stiffens_at_a_place_is_a_spring() -> None:
    spring = effect("nonlinear_spring")
    for values in ((-0.6, 0.5, 0.2), (2.0, 0.4, 0.1)):
        plant = Plant(DESIGN, (Inserted(spring.name, spring.form("step"), values),))
        found = diagnose([a_record(plant)], DESIGN, (), UP_TO_TWO).diagnosis
        assert [c.name for c in found.causes] == ["nonlinear_spring"]
