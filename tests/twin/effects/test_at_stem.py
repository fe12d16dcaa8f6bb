"""Forms that go by where the stem is: when it is slow, those that go by where it is pulled to; in motion not."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

D = DesignModel()
PAIRS = [
    ("nonlinear_spring", "bow", "stem_bow", (0.5,)),
    ("nonlinear_spring", "bow_and_swing", "stem_bow_and_swing", (0.3, -0.2)),
    ("nonlinear_spring", "area_slope", "stem_area", (0.05,)),
    ("position_dependent_friction", "spot", "stem_spot", (0.5, 0.4, 0.1)),
    ("position_dependent_friction", "bow", "stem_bow", (0.4,)),
    ("position_dependent_friction", "open_end", "stem_open_end", (0.5,)),
    ("position_dependent_friction", "closed_end", "stem_closed_end", (0.5,)),
    ("spring_asymmetry", "hinged_open", "at_stem", (0.1,)),
]


def stem(name: str, form: str, values: tuple[float, ...], span_s: float) -> FloatArray:
    """A stroke to the closed stop and back, in `span_s`."""
    time_s = np.linspace(0.0, span_s, 4001)
    c = Plant(D, (Inserted(name, effect(name).form(form), values),)).coefficients(span_s)
    grid = make_grid(time_s, span_s / 8000.0)
    pressure = np.interp(grid.fine_time_s, [0.0, 0.5 * span_s, span_s], [6.0, 14.0, 4.0])
    return stem_response(c, grid, pressure, 0.0, 0.0)[grid.offsets]


@pytest.mark.parametrize(("name", "of_pull", "of_stem", "values"), PAIRS)
def test_the_same_when_slow_and_not_when_fast(name: str, of_pull: str, of_stem: str, values: tuple[float, ...]) -> None:
    slow, fast = (
        np.sqrt(np.mean((stem(name, of_pull, values, span_s) - stem(name, of_stem, values, span_s)) ** 2)) / D.travel
        for span_s in (20000.0, 40.0)
    )
    assert slow < 0.008  # a steep corner is never slow
    assert fast > max(2.5 * slow, 0.01)
