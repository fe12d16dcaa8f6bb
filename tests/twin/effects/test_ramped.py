"""A converter that ramps to its set point before its lag: against the closed form, and row by row."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.live.twin import LiveTwin
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response
from twin.model.timegrid import make_grid
from twin.replay.simulate import Start

D = DesignModel()
TIME_S = np.arange(0.0, 12.05, 0.1)
SLOWNESS = 0.5
PLANT = Plant(D, (Inserted("ep_rate_limit", effect("ep_rate_limit").form("ramped"), (SLOWNESS,)),))


def closed_form(step: float) -> FloatArray:
    """Response of the lag to a ramp that begins at 1 s and ends when it has gone `step`."""

    def ramp(t: FloatArray) -> FloatArray:
        late = np.maximum(t, 0.0)
        return np.asarray((late - D.ep_tau_s * (1.0 - np.exp(-late / D.ep_tau_s))) / SLOWNESS)

    return ramp(TIME_S - 1.0) - ramp(TIME_S - 1.0 - SLOWNESS * step)


@pytest.mark.parametrize("step", [4.0, 0.03])
def test_a_step_is_a_ramp_behind_the_lag(step: float) -> None:
    """A small step is over within one fine step of the grid, a large one takes seconds."""
    grid = make_grid(TIME_S, 0.02)
    command = np.where(TIME_S > 1.05, 6.0 + step, 6.0)
    got = pressure_response(PLANT.coefficients(12.0), grid, command, 6.0)[grid.offsets]
    assert np.max(np.abs(got - 6.0 - closed_form(step))) < 0.002 * step


def test_row_by_row_it_is_the_same() -> None:
    grid = make_grid(TIME_S, 0.02)
    command = 9.0 + 2.0 * np.sign(np.sin(TIME_S)) + 0.2 * np.sin(7.0 * TIME_S)
    want = pressure_response(PLANT.coefficients(12.0), grid, command, command[0])[grid.offsets]
    live = LiveTwin(PLANT, 0.0, command[0], Start(float(command[0]), 0.0, 0.0), 12.0, 0.02)
    got = [command[0], *(live.step(t, u)[0] for t, u in zip(TIME_S[1:], command[1:], strict=True))]
    assert np.allclose(got, want, atol=1e-9)
