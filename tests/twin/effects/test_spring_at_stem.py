"""A spring whose stiffness depends on the way, as the stem feels it: against small steps of its law."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.judged import UP_TO_TWO, a_record
from tests.twin.loops import FRICTIONS, D, at_once, in_small_steps, plant, row_by_row, uneven_in_small_steps
from twin.diagnose import diagnose
from twin.model.plant import Plant


def uneven(friction: str, asymmetry: float) -> Plant:
    return plant(friction, "spring_asymmetry", "at_stem", (asymmetry,))


@pytest.mark.thorough
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("asymmetry", [0.2, -0.15])
def test_like_small_steps_of_its_law(friction: str, asymmetry: float) -> None:
    expected = in_small_steps(friction, asymmetry=asymmetry)
    assert np.max(np.abs(at_once(uneven(friction, asymmetry)) - expected)) < 0.005 * D.travel
    assert np.allclose(row_by_row(uneven(friction, asymmetry)), at_once(uneven(friction, asymmetry)), atol=1e-9)


@pytest.mark.parametrize("asymmetry", [0.2, -0.15])
def test_its_lags_go_with_it(asymmetry: float) -> None:
    one = plant("before the lag", "spring_asymmetry", "with_lags", (asymmetry,))
    assert np.max(np.abs(at_once(one) - uneven_in_small_steps(asymmetry))) < 0.004 * D.travel
    assert np.allclose(row_by_row(one), at_once(one), atol=1e-9)


@pytest.mark.thorough
def test_it_is_told_from_a_stiffness_of_what_pulls_the_stem() -> None:
    found = diagnose([a_record(uneven("before the lag", 0.05), seed=4)], D, (), UP_TO_TWO).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("spring_asymmetry", "at_stem")]
    assert found.causes[0].parameters["asymmetry"].value == pytest.approx(0.05, abs=0.005)
