"""Both end stops are elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, pressure_response, stem_response
from twin.model.timegrid import make_grid

DESIGN = DesignModel()


def stops(form: str, *values: float) -> Inserted:
    return Inserted("reduced_travel", effect("reduced_travel").form(form), values)


@pytest.mark.parametrize("hit", ["", "_hit"])
def test_both_stops_are_one_and_the_other(hit: str) -> None:
    time_s = 0.1 * np.arange(1200)
    grid, command = make_grid(time_s, 0.05), 8.0 + 6.0 * np.sin(0.1 * time_s)
    one_by_one = Plant(DESIGN, (stops(f"lower_stop{hit}", 0.03), stops(f"upper_stop{hit}", 0.05)))
    at_once = Plant(DESIGN, (stops(f"both_stops{hit}", 0.03, 0.05),))
    pressure = pressure_response(Plant(DESIGN).coefficients(120.0), grid, command, 8.0)
    here, there = (stem_response(p.coefficients(120.0), grid, pressure, 0.2, 0.2) for p in (at_once, one_by_one))
    np.testing.assert_array_equal(here, there)
    assert here.max() == pytest.approx(0.95 * DESIGN.travel, rel=1e-3)
    assert here.min() == pytest.approx(0.03 * DESIGN.travel, rel=1e-2)


@pytest.mark.thorough
def test_a_valve_that_reaches_neither_end_has_a_reduced_travel() -> None:
    found = diagnose([a_record(Plant(DESIGN, (stops("both_stops", 0.04, 0.02),)))], DESIGN, (), UP_TO_TWO).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("reduced_travel", "both_stops")]
