"""A spring that relaxes: against small steps of its law, in every loop that moves a stem."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.judged import UP_TO_TWO, a_record
from tests.twin.loops import FRICTIONS, D, at_once, in_small_steps, plant, row_by_row
from twin.diagnose import diagnose
from twin.model.plant import Plant


def relaxing(friction: str, share: float, tail_s: float) -> Plant:
    return plant(friction, "creep", "spring_tail", (share, tail_s))


@pytest.mark.thorough
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("relax", [(0.1, 20.0), (0.4, 8.0)])
def test_like_small_steps_of_its_law(friction: str, relax: tuple[float, float]) -> None:
    assert (
        np.max(np.abs(at_once(relaxing(friction, *relax)) - in_small_steps(friction, relax=relax))) < 0.004 * D.travel
    )


@pytest.mark.parametrize("friction", FRICTIONS)
def test_live_and_with_other_steps_as_at_once(friction: str) -> None:
    one = relaxing(friction, 0.2, 15.0)
    assert np.max(np.abs(at_once(one, 0.05) - at_once(one, 0.005))) < 0.003 * D.travel
    assert np.allclose(row_by_row(one), at_once(one), atol=1e-9)


@pytest.mark.thorough
def test_it_is_told_from_a_tail_of_the_stem() -> None:
    found = diagnose([a_record(relaxing("before the lag", 0.08, 20.0), seed=5)], D, (), UP_TO_TWO).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("creep", "spring_tail")]
    assert found.causes[0].parameters["share"].value == pytest.approx(0.08, abs=0.01)
    assert found.causes[0].parameters["tail"].value == pytest.approx(20.0, rel=0.15)
