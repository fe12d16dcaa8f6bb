"""What the updated model has elsewhere than the design, though it was not accused, is said."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.diagnose import Settings, diagnose
from twin.fit.numbers import retuned
from twin.judge.moved import moved_numbers
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.search.search_rules import SearchRules

DESIGN = DesignModel()


def test_numbers_that_moved_far_are_said_unless_accused() -> None:
    updated = retuned(DESIGN, {"deadband": 2.6, "tau": 2.75, "ep_tau": 0.45})
    (note,) = moved_numbers(DESIGN, updated, ("creep",))
    assert "deadband 2.6 instead of 2.96 psi" in note.what
    assert "ep_tau 0.45 instead of 0.3 s" in note.what
    assert " tau " not in note.what  # 2 % are no news
    (rest,) = moved_numbers(DESIGN, updated, ("parameter:deadband",))
    assert "deadband" not in rest.what
    assert moved_numbers(DESIGN, updated, ("parameter:deadband", "parameter:ep_tau")) == []


def test_a_deadband_where_the_design_has_none() -> None:
    without = replace(DESIGN, a1=7.3, a2=7.3)
    (note,) = moved_numbers(without, retuned(without, {"deadband": 0.3}), ())
    assert "deadband 0.3 instead of 0 psi" in note.what


@pytest.mark.thorough
def test_a_diagnosis_says_what_it_re_tuned_where_nothing_explains() -> None:
    """A damping that grows with the speed alike both ways is nothing known; a longer lag takes most of it."""
    damping = Inserted("asymmetric_damping", effect("asymmetric_damping").form("orifice_each_way"), (1.5, 1.5))
    settings = Settings(search=SearchRules(most=1))
    found = diagnose([a_record(Plant(DESIGN, (damping,)))], DESIGN, settings=settings).diagnosis
    assert found.verdict == "unexplained"
    assert any("the updated model has tau 3.4" in note.what for note in found.data_quality)
