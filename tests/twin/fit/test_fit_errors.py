"""Standard errors of a fit with a prior, where the data remember more than the fit believes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from twin.fit.fitting import Fit

EXCESS = 20.0


def fitted(z: float, information: float, spread: float, unit: float = 1.0) -> Fit:
    """A fit of one unknown, as a search would leave it; `information` is J'J of the data."""
    space: Any = SimpleNamespace(spreads=np.array([spread]), unknowns=(SimpleNamespace(unit=unit, centre=0.0),))
    normal = np.array([[information + spread**-2]])
    return Fit(space, np.array([z]), 1.0, 0.0, np.zeros(1), normal, 1)


@pytest.mark.parametrize("information", [0.4, 4.0, 40.0, 4000.0])
def test_intervals_hold_the_truth_whatever_prior_and_data_say(information: float) -> None:
    dice = np.random.default_rng(1)
    spread, hits, rows = 0.5, 0, 4000
    for _ in range(rows):
        truth = spread * dice.standard_normal()
        data = truth + np.sqrt(EXCESS / information) * dice.standard_normal()
        z = information * data / (information + spread**-2)  # what least squares make of both
        hits += abs(z - truth) <= 1.96 * fitted(z, information, spread).errors(EXCESS)[0]
    assert hits / rows == pytest.approx(0.95, abs=0.012)


def test_what_the_data_say_nothing_about_is_as_unsure_as_before_and_no_more() -> None:
    assert fitted(0.0, 0.0, 0.5, unit=-2.0).errors(EXCESS) == pytest.approx([1.0])
    unfitted = fitted(0.0, 0.0, 0.5)
    unfitted = Fit(unfitted.space, unfitted.z, 1.0, 0.0, unfitted.residuals, np.zeros((1, 1)), 1)
    assert unfitted.errors(EXCESS) == pytest.approx([0.5])


def test_what_only_the_data_know_is_scaled_whole() -> None:
    assert fitted(0.0, 4e4, 1e6).errors(EXCESS) == pytest.approx([np.sqrt(EXCESS / 4e4)])
    assert fitted(0.0, 4e4, 1e6).errors(1.0) == pytest.approx(fitted(0.0, 4e4, 1e6).deviations())
