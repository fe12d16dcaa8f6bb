"""A port lets less air through as the pressure nears that of a weak supply; against an ODE solver."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from control.design import DesignModel
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel()
ATMOSPHERE_PSI = 14.6959


def weak(supply_psi: float, width: float) -> Plant:
    return Plant(
        DESIGN, (Inserted("supply_saturation", effect("supply_saturation").form("subsonic"), (supply_psi, width)),)
    )


@pytest.mark.parametrize(("goal_psi", "width"), [(11.0, 1.3), (12.4, 1.7), (15.0, 1.0)])
def test_it_fills_as_the_flow_through_a_port_does(goal_psi: float, width: float) -> None:
    supply_psi = 12.6

    def rate(_: float, p: np.ndarray) -> np.ndarray:
        above = np.clip(((p + ATMOSPHERE_PSI) / (supply_psi + ATMOSPHERE_PSI) - 0.5) / 0.5, 0.0, 1.0)
        return np.minimum(1.0, width * np.sqrt(1.0 - above**2)) * (goal_psi - p) / DESIGN.ep_tau_s

    time_s = 0.05 * np.arange(161)
    grid, c = make_grid(time_s, 0.05), weak(supply_psi, width).coefficients(8.0)
    command = np.where(time_s > 0.0, goal_psi, 6.0)
    got = pressure_response(c, grid, command, 6.0)[grid.offsets]
    want = solve_ivp(rate, (0.0, 8.0), [6.0], t_eval=time_s, rtol=1e-8, max_step=0.01).y[0]
    assert np.max(np.abs(got - np.minimum(want, supply_psi))) < 0.01
    assert got.max() <= supply_psi


@pytest.mark.parametrize(("goal_psi", "span_psi"), [(11.0, 1.0), (12.4, 2.5), (15.0, 0.8)])
def test_a_supply_whose_flow_falls_evenly_to_none(goal_psi: float, span_psi: float) -> None:
    supply_psi = 12.0

    def rate(_: float, p: np.ndarray) -> np.ndarray:
        return np.clip((supply_psi - p) / span_psi, 0.0, 1.0) * (goal_psi - p) / DESIGN.ep_tau_s

    time_s = 0.05 * np.arange(161)
    one = Inserted("supply_saturation", effect("supply_saturation").form("starved"), (supply_psi, span_psi))
    grid, c = make_grid(time_s, 0.05), Plant(DESIGN, (one,)).coefficients(8.0)
    command = np.where(time_s > 0.0, goal_psi, 6.0)
    got = pressure_response(c, grid, command, 6.0)[grid.offsets]
    want = solve_ivp(rate, (0.0, 8.0), [6.0], t_eval=time_s, rtol=1e-8, max_step=0.01).y[0]
    assert np.max(np.abs(got - want)) < 0.01
    assert got.max() <= supply_psi


def test_it_exhausts_as_before() -> None:
    time_s = 0.1 * np.arange(40)
    command, grid = np.where(time_s > 0.0, 5.0, 11.0), make_grid(time_s, 0.05)
    plain, port = (
        pressure_response(p.coefficients(4.0), grid, command, 11.0) for p in (Plant(DESIGN), weak(12.0, 1.2))
    )
    np.testing.assert_allclose(port, plain, atol=1e-12)


@pytest.mark.thorough
def test_a_port_that_is_short_of_pressure_is_a_weak_supply() -> None:
    found = diagnose([a_record(weak(11.8, 1.3))], DESIGN, (), UP_TO_TWO).diagnosis
    assert [c.name for c in found.causes] == ["supply_saturation"]
