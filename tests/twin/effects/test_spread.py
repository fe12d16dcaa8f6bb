"""Spreads of play widths: what a form says of the widths is what the plays have."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import lognorm

from control.design import DesignModel
from logs.recording import FloatArray
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

DESIGN = DesignModel()
HYSTERESIS = effect("distributed_hysteresis")


def widths(form: str, *values: float) -> FloatArray:
    """The half widths of the plays [psi], all of the same weight."""
    plant = Plant(DESIGN, (Inserted(HYSTERESIS.name, HYSTERESIS.form(form), values),))
    c = plant.coefficients(60.0)
    assert np.allclose(c.weights, 1.0 / c.weights.size)
    return 0.5 * DESIGN.deadband + c.spreads


@pytest.mark.parametrize(("form", "value"), [("uniform", 0.3), ("exponential", 0.3), ("lognormal", 0.4)])
def test_the_mean_width_is_that_of_the_design(form: str, value: float) -> None:
    assert widths(form, value).mean() == pytest.approx(0.5 * DESIGN.deadband, rel=1e-9)
    assert np.ptp(widths(form, value)) > 0.3
    assert np.ptp(widths(form, 0.0)) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("scatter", [0.1, 0.4, 1.0])
def test_the_logarithms_of_lognormal_widths_are_normal(scatter: float) -> None:
    """Each play stands for the middle of its share of them."""
    got = widths("lognormal", scatter)
    wanted = lognorm(scatter).ppf((np.arange(got.size) + 0.5) / got.size)
    np.testing.assert_allclose(got / np.median(got), wanted / np.median(wanted), rtol=1e-9)
