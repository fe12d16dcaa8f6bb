"""Friction that turns with the speed: against an integration of scipy's, and against its limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.loops import advanced
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

D = DesignModel()
TIME_S = np.arange(0.0, 60.0, 0.1)
PRESSURE = np.interp(TIME_S, [0, 2, 2.5, 20, 30, 31, 40, 60], [8.5, 8.5, 10.5, 9.5, 7.0, 9.8, 9.3, 8.0])
X0 = 0.3


def plant(share: float, speed: float) -> Plant:
    return Plant(D, (Inserted("friction_in_motion", effect("friction_in_motion").form("rounded"), (share, speed)),))


def stem(one: Plant, step_s: float = 0.02, pressure: FloatArray = PRESSURE) -> FloatArray:
    grid = make_grid(TIME_S, step_s)
    fine = np.interp(grid.fine_time_s, TIME_S, pressure)
    return stem_response(one.coefficients(60.0), grid, fine, X0, X0)[grid.offsets]


def integrated(speed: float) -> FloatArray:
    """All of the friction turns with the speed: the balance solved for it, and integrated with controlled steps."""
    half = 0.5 * D.compliance * D.deadband

    def slope(t: float, state: FloatArray) -> list[float]:
        pull = D.compliance * (np.interp(t, TIME_S, PRESSURE) - D.offset) - state[0]
        most = abs(pull) / D.tau_s + 1e-9
        v = brentq(lambda v: D.tau_s * v + half * np.tanh(v / speed) - pull, -most, most, xtol=1e-12)
        return [float(np.clip(v, -D.rate_limit, D.rate_limit))]

    found = solve_ivp(slope, (0.0, TIME_S[-1]), [X0], t_eval=TIME_S, max_step=0.2, rtol=1e-6, atol=1e-8)
    return np.asarray(found.y[0])


@pytest.mark.parametrize("speed", [0.002, 0.03])
def test_like_an_integration_with_controlled_steps(speed: float) -> None:
    assert np.max(np.abs(stem(plant(1.0, speed)) - integrated(speed))) < 0.0005 * D.travel


def test_the_limit_of_no_speed_is_friction_that_turns_at_once() -> None:
    full = Plant(D, (Inserted("friction_in_motion", effect("friction_in_motion").form("full"), ()),))
    part = Plant(D, (Inserted("friction_in_motion", effect("friction_in_motion").form("partial"), (0.5,)),))
    assert np.max(np.abs(stem(plant(1.0, 1e-6)) - stem(full))) < 0.002 * D.travel
    assert np.max(np.abs(stem(plant(0.5, 1e-6)) - stem(part))) < 0.002 * D.travel


def test_it_never_sticks() -> None:
    """Inside the deadband it creeps to where no force is left, at a speed that its pull over the friction makes."""
    held = np.full(TIME_S.size, D.offset + X0 / D.compliance - 0.4)
    x = stem(plant(1.0, 0.004), pressure=held)
    pull = 0.4 / (0.5 * D.deadband)
    assert (X0 - x[10]) / 1.0 == pytest.approx(0.004 * np.arctanh(pull), rel=0.06)
    assert np.all(np.diff(x) < 0.0)


def test_coarse_steps_stops_and_rows_make_no_difference() -> None:
    one = plant(0.8, 0.01)
    assert np.max(np.abs(stem(one, 0.1) - stem(one, 0.005))) < 0.002 * D.travel
    wide = np.where(TIME_S < 30.0, 14.0, 3.0)
    there = stem(one, pressure=wide)
    assert D.travel - 1e-4 < there.max() <= D.travel and 0.0 <= there.min() < 1e-4
    assert np.allclose(advanced(one.coefficients(60.0), TIME_S, PRESSURE, X0), stem(one), atol=1e-9)
