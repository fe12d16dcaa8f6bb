"""Friction that grows with the pressure behind a play, with soft stops: against a plain integration in small steps."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

D = DesignModel()
TIME_S = np.arange(0.0, 80.0, 0.05)
#: Against both stops, and back and forth between them.
PRESSURE = np.interp(TIME_S, [0, 10, 16, 28, 33, 40, 46, 53, 60, 80], [6, 13.5, 13.5, 5, 5, 11.5, 8, 10.5, 9, 14.5])
SHARE, LOAD, BELOW, ABOVE = 0.7, 0.28, 0.05, 0.08


def stepped(load: float, below: float, above: float, h: float = 5e-3) -> FloatArray:
    """The same by explicit steps: the play, then the target nearest to the stem that friction allows, then its lag."""
    wide = 0.5 * D.deadband * (1.0 - SHARE)
    behind, x, rows = PRESSURE[0] + wide, 0.0, [0.0]
    for a, b in pairwise(PRESSURE.tolist()):
        for k in range(per := round((TIME_S[1] - TIME_S[0]) / h)):
            p = a + (b - a) * (k + 0.5) / per
            behind = max(p - wide, min(p + wide, behind))
            target = min(max(x, _balance(behind, +1.0, load)), _balance(behind, -1.0, load))
            target = min(max(target, -below), D.travel + above)
            speed = max(-D.rate_limit, min(D.rate_limit, (target - x) / D.tau_s))
            x = min(max(x + speed * h, 0.0), D.travel)
        rows.append(x)
    return np.array(rows)


def _balance(p: float, sign: float, load: float) -> float:
    """Where spring and friction balance a pressure, for a stem that closes (1) or opens (-1); found by halving."""
    low, high, (band, rest) = -0.5, 1.5, (sign * 0.5 * D.deadband, D.offset)
    for _ in range(18):
        w = 0.5 * (low + high)
        friction = band * (SHARE + load * (min(max(w / D.travel, 0.0), 1.0) - 0.5))
        low, high = (w, high) if p > rest + w / D.compliance + friction else (low, w)
    return w


@pytest.mark.parametrize(
    ("load", "below", "above"),
    [
        pytest.param(0.0, 0.0, 0.0, marks=pytest.mark.thorough),
        pytest.param(LOAD, 0.0, 0.0, marks=pytest.mark.thorough),
        (LOAD, BELOW, ABOVE),
    ],
)
def test_same_as_small_steps(load: float, below: float, above: float) -> None:
    form = effect("friction_in_motion").form("partial_loaded")
    plant = Plant(D, (Inserted("friction_in_motion", form, (SHARE, load, below, above)),))
    grid = make_grid(TIME_S, 0.02)
    fine = np.interp(np.interp(np.arange(grid.n_fine), grid.offsets, TIME_S), TIME_S, PRESSURE)
    x = stem_response(plant.coefficients(float(TIME_S[-1])), grid, fine, 0.0, 0.0)[grid.offsets]
    assert np.max(np.abs(x - stepped(load, below, above))) < 4e-4


def test_no_friction_drives() -> None:
    """A load that would make it less than nothing at the open end makes it nothing there."""
    form = effect("friction_in_motion").form("partial_loaded")
    shifts = []
    for load in (0.2, 0.9):
        plant = Plant(D, (Inserted("friction_in_motion", form, (0.1, load, 0.0, 0.0)),))
        shifts.append(plant.coefficients(1.0).close_shift)
    assert shifts[0][0] == pytest.approx(-0.5 * D.deadband * 0.1)
    assert shifts[1] == pytest.approx(shifts[0])
