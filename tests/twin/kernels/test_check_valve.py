"""A damper whose check valve opens above a speed: against small steps of its law, in every loop that moves a stem."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.judged import a_record
from tests.twin.loops import FRICTIONS, PRESSURE, SMALL_S, TIME_S, D, at_once, plant, row_by_row
from twin.diagnose import diagnose
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

WAYS = ("closing", "opening")


def in_small_steps(friction: str, way: str, eases: float, above: float):
    """dx/dt = (w - x) / tau, and `way` above a speed times 1 + eases what it has above that."""
    time_s = np.arange(0.0, TIME_S[-1] + SMALL_S, SMALL_S)
    x, w, found = 0.0, 0.0, np.empty(time_s.size)
    for k, p in enumerate(np.interp(time_s, TIME_S, PRESSURE)):
        found[k] = x
        bottom, top = D.compliance * (p - D.a1), D.compliance * (p - D.a2)
        w = min(D.travel, max(0.0, bottom, min(top, w if friction == "before the lag" else x)))
        speed, edge = abs(w - x) / D.tau_s, above * D.rate_limit
        if speed > edge and (w > x) == (way == "closing"):
            speed = edge + (1.0 + eases) * (speed - edge)
        x += SMALL_S * min(speed, D.rate_limit) * np.sign(w - x)
    return np.interp(TIME_S, time_s, found)


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("eases", "above"), [(1.0, 0.2), (4.0, 0.6)])
def test_like_small_steps_of_its_law(friction: str, way: str, eases: float, above: float) -> None:
    one = plant(friction, "asymmetric_damping", f"check_valve_{way}", (eases, above))
    law = in_small_steps(friction, way, eases, above)
    assert np.max(np.abs(at_once(one) - law)) < 0.003 * D.travel
    assert np.max(np.abs(law - in_small_steps(friction, way, 0.0, above))) > 0.01 * D.travel
    assert np.allclose(row_by_row(one), at_once(one), atol=1e-9)


@pytest.mark.parametrize("way", WAYS)
def test_a_heavy_stem_has_it_too(way: str) -> None:
    """With hardly any mass it moves as without, and so it does in the live twin."""
    light = plant("before the lag", "asymmetric_damping", f"check_valve_{way}", (4.0, 0.3))
    mass = Inserted("additional_lag", effect("additional_lag").form("inertia"), (0.01,))
    heavy = Plant(light.design, (*light.inserted, mass))
    assert np.max(np.abs(at_once(heavy) - at_once(light))) < 0.005 * D.travel
    assert np.allclose(row_by_row(heavy), at_once(heavy), atol=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("way", WAYS)
def test_a_check_valve_is_told_from_other_dampings(way: str) -> None:
    one = plant("before the lag", "asymmetric_damping", f"check_valve_{way}", (1.5, 0.15))
    found = diagnose([a_record(one, seed=3)], D).diagnosis
    assert [c.name for c in found.causes] == ["asymmetric_damping"]
    assert found.causes[0].form == f"check_valve_{way}"
    assert found.causes[0].parameters["eases"].value == pytest.approx(1.5, abs=0.4)
    assert found.causes[0].parameters["above"].value == pytest.approx(0.15, abs=0.03)
