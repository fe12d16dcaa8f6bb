"""A stem with mass: against an integration of scipy's, and against its limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.inertia import inertia_pass
from twin.kernels.valve import coupled_coefficients
from twin.kernels.valve_slots import V_INERTIA_S, V_TAU_AFTER_S
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

TIME_S = np.arange(0.0, 60.0, 0.05)
PRESSURE = np.where(TIME_S < 2.0, 9.0, np.where(TIME_S < 30.0, 10.4, 7.0))


def stem(inertia_s: float | None, travel: float = 2.0, x0: float = 0.5) -> FloatArray:
    """The stem at the rows; no inertia for None."""
    cause = Inserted("additional_lag", effect("additional_lag").form("inertia"), (inertia_s or 0.0,))
    plant = Plant(replace(DesignModel(), travel=travel), () if inertia_s is None else (cause,))
    grid = make_grid(TIME_S, 0.02)
    fine = np.interp(np.interp(np.arange(grid.n_fine), grid.offsets, TIME_S), TIME_S, PRESSURE)
    return stem_response(plant.coefficients(60.0), grid, fine, x0, x0)[grid.offsets]


def integrated(inertia_s: float) -> FloatArray:
    """The same between the two curves by a step-size controlled integration; the play is fed from its own target."""
    d = DesignModel()
    fine_s = np.linspace(0.0, TIME_S[-1], 12_000).tolist()
    pressure, w, target = np.interp(fine_s, TIME_S, PRESSURE), 0.5, []
    for p in pressure.tolist():
        w = max(d.compliance * (p - d.a1), min(d.compliance * (p - d.a2), w))
        target.append(w)

    def slope(t: float, state: FloatArray) -> list[float]:
        position, speed = state.tolist()
        k = min(int(t / fine_s[1]), len(target) - 2)
        aim = target[k] + (target[k + 1] - target[k]) * (t / fine_s[1] - k)
        pull = min(max((aim - position) / d.tau_s, -d.rate_limit), d.rate_limit)
        return [speed, (pull - speed) / inertia_s]

    found = solve_ivp(slope, (0.0, TIME_S[-1]), [0.5, 0.0], t_eval=TIME_S, max_step=0.1, rtol=1e-6, atol=1e-8)
    return np.asarray(found.y[0])


@pytest.mark.parametrize("inertia_s", [0.2, pytest.param(2.0, marks=pytest.mark.thorough)])
def test_like_an_integration_with_controlled_steps(inertia_s: float) -> None:
    assert np.max(np.abs(stem(inertia_s) - integrated(inertia_s))) < 0.0004 * 0.5625


def test_without_mass_it_is_the_design() -> None:
    assert np.array_equal(stem(0.0), stem(None))
    assert np.max(np.abs(stem(1e-3) - stem(None))) < 0.001 * 0.5625


def test_a_heavy_stem_swings_beyond_its_target_and_a_light_one_does_not() -> None:
    """The limit is a quarter of the lag."""
    opened = TIME_S > 30.0
    rests = stem(None)[-1]
    assert np.min(stem(0.2 * DesignModel().tau_s)[opened]) > rests - 1e-4
    assert np.min(stem(2.0)[opened]) < rests - 0.01


def test_it_stays_within_the_stops_and_loses_its_speed_there() -> None:
    x = stem(2.0, travel=0.4, x0=0.1)
    assert x.min() >= 0.0 and x.max() <= 0.4


def test_beside_what_acts_on_the_target_it_is_a_second_lag() -> None:
    c = Plant(
        DesignModel(), (Inserted("additional_lag", effect("additional_lag").form("inertia"), (0.7,)),)
    ).coefficients(9.0)
    assert c.valve[V_INERTIA_S] == 0.7
    assert coupled_coefficients(c.valve)[V_TAU_AFTER_S] == pytest.approx(0.7)
    assert c.valve[V_TAU_AFTER_S] == 0.0


def test_the_stop_takes_the_speed() -> None:
    """Else the stem would stay at it while the pull is already back."""
    time_s = np.array([0.0, 0.1])
    offsets, out, state = np.array([0, 5]), np.empty(6), np.array([0.5, 0.3])
    lags_s, rates, stops = np.full(2, 2.7), np.full(2, 0.12), np.array([0.0, 0.5])
    inertia_pass(time_s, offsets, np.full(6, 0.5), lags_s, rates, stops, 2.0, (0.0, 0.0, 0.0), state, out)
    assert np.all(out == 0.5) and state[1] == 0.0


def test_coarse_steps_give_the_same_swing() -> None:
    """Second order: what a step of 0.1 s gets wrong is small against what its length would suggest."""
    rows = slice(None, None, 2)
    plant = Plant(
        replace(DesignModel(), travel=2.0),
        (Inserted("additional_lag", effect("additional_lag").form("inertia"), (2.0,)),),
    )
    found = []
    for step_s in (0.1, 0.005):
        grid = make_grid(TIME_S[rows], step_s)
        fine = np.interp(np.interp(np.arange(grid.n_fine), grid.offsets, TIME_S[rows]), TIME_S, PRESSURE)
        found.append(stem_response(plant.coefficients(60.0), grid, fine, 0.5, 0.5)[grid.offsets])
    assert np.max(np.abs(found[0] - found[1])) < 0.004
