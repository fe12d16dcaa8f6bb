"""Drag that is its own each way: against small steps of its law, in every loop that moves a stem."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.judged import a_record
from tests.twin.loops import FRICTIONS, D, at_once, in_small_steps, plant, row_by_row
from twin.diagnose import diagnose
from twin.model.plant import Plant


def dragged(friction: str, drag: tuple[float, float]) -> Plant:
    return plant(friction, "asymmetric_damping", "drag_each_way", drag)


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("drag", [(0.5, -0.4), (-0.3, 0.8), (0.0, -0.5)])
def test_like_small_steps_of_its_law(friction: str, drag: tuple[float, float]) -> None:
    """What a stop takes of the pull is there for the drag."""
    assert np.max(np.abs(at_once(dragged(friction, drag)) - in_small_steps(friction, drag))) < 0.004 * D.travel


@pytest.mark.parametrize("friction", FRICTIONS)
def test_live_and_with_other_steps_as_at_once(friction: str) -> None:
    one = dragged(friction, (0.5, -0.4))
    assert np.max(np.abs(at_once(one, 0.05) - at_once(one, 0.005))) < 0.003 * D.travel
    assert np.allclose(row_by_row(one), at_once(one), atol=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("form", ["orifice_each_way", "orifice_within_stops"])
@pytest.mark.parametrize("throttled", [(2.0, 0.0), (0.0, 5.0)])
def test_an_orifice_like_small_steps_of_its_law(friction: str, form: str, throttled: tuple[float, float]) -> None:
    one = plant(friction, "asymmetric_damping", form, throttled)
    law = in_small_steps(friction, throttled=throttled, within=form == "orifice_within_stops")
    assert np.max(np.abs(at_once(one) - law)) < 0.004 * D.travel
    assert np.allclose(row_by_row(one), at_once(one), atol=1e-9)


@pytest.mark.thorough
def test_a_stem_that_opens_with_less_drag_is_told_from_other_lags() -> None:
    found = diagnose([a_record(dragged("before the lag", (0.0, -0.35)), seed=3)], D).diagnosis
    assert [c.name for c in found.causes] == ["asymmetric_damping"]
    assert found.causes[0].form == "drag_each_way"
    assert found.causes[0].parameters["opening"].value == pytest.approx(-0.35, abs=0.02)
    assert found.causes[0].parameters["closing"].value == pytest.approx(0.0, abs=0.02)


def test_a_speed_of_its_own_each_way_is_not_that_of_the_lag() -> None:
    """Half the lag's difference alone, half the speed's alone: each moves only what it is of."""
    apart = "two_lags_and_rates_apart"
    fast = np.diff(at_once(plant("before the lag", "asymmetric_damping", apart, (0.0, 0.2)), 0.005)) / 0.1
    assert fast.max() == pytest.approx(0.8 * D.rate_limit, rel=1e-3)
    assert fast.min() == pytest.approx(-1.2 * D.rate_limit, rel=1e-3)
    one = plant("before the lag", "asymmetric_damping", apart, (0.2, 0.0))
    other = plant("before the lag", "asymmetric_damping", "two_lags", (0.2,))
    assert np.array_equal(one.coefficients(1.0).valve, other.coefficients(1.0).valve)


@pytest.mark.thorough
def test_lags_and_speeds_that_differ_by_their_own_are_found() -> None:
    one = plant("before the lag", "asymmetric_damping", "two_lags_and_rates_apart", (-0.12, -0.06))
    found = diagnose([a_record(one, seed=5)], D).diagnosis
    assert [c.name for c in found.causes] == ["asymmetric_damping"]
    assert found.causes[0].parameters["of_the_speeds"].value == pytest.approx(-0.06, abs=0.02)
