"""A burr along the stroke: friction that is higher at some positions in one direction only."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.play import play_target
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, curve_tables

DESIGN = DesignModel()
CENTRE, WIDTH = 0.5, 0.1


def loop(form: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pressures of a slow stroke there and back, and where the stem is pulled to on either."""
    friction = effect("position_dependent_friction")
    burr = Inserted(friction.name, friction.form(form), (0.4, CENTRE, WIDTH))
    c = Plant(DESIGN, (burr,)).coefficients(1.0)
    up = np.linspace(4.0, 13.0, 4001)
    there_and_back = np.concatenate([up, up[::-1]])
    stops = (0.0, DESIGN.travel)
    w = play_target(there_and_back, np.zeros(1), stops, curve_tables(c), c.spreads, c.weights, 0.0)
    return up, w[: up.size], w[up.size :][::-1]


@pytest.mark.parametrize(("form", "closing", "opening"), [("closing_spot", 0.4, 0.0), ("opening_spot", 0.0, 0.4)])
@pytest.mark.parametrize("at", [0.2, 0.5, 0.62])
def test_more_pressure_is_needed_one_way_only(form: str, closing: float, opening: float, at: float) -> None:
    up, there, back = loop(form)
    bell = np.exp(-0.5 * ((at - CENTRE) / WIDTH) ** 2)
    line = at * DESIGN.travel / DESIGN.compliance
    assert np.interp(at * DESIGN.travel, there, up) == pytest.approx(DESIGN.a1 + line + closing * bell, abs=0.012)
    assert np.interp(at * DESIGN.travel, back, up) == pytest.approx(DESIGN.a2 + line - opening * bell, abs=0.012)


@pytest.mark.parametrize("form", ["closing_spot", "opening_spot"])
def test_a_burr_never_helps(form: str) -> None:
    height = effect("position_dependent_friction").form(form).parameters[0]
    assert (height.name, height.lower) == ("height", 0.0)
