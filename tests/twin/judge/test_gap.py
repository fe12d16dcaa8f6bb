"""What is left without a cause, on rows that no fit has seen."""

from __future__ import annotations

import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.diagnose import Settings, diagnose
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.search.search_rules import SearchRules


@pytest.mark.thorough
def test_without_the_only_cause_of_a_converter_the_design_is_as_given() -> None:
    """The numbers that moved beside the cause go with it."""
    late = Inserted("dead_time", effect("dead_time").form("pure_delay"), (0.3,))
    settings = Settings(search=SearchRules(most=1))
    found = diagnose([a_record(Plant(DesignModel(), (late,)))], DesignModel(), settings=settings).diagnosis
    (cause,) = found.causes
    assert (cause.name, cause.stage) == ("dead_time", "ep")
    assert cause.heldout_gap_without == pytest.approx(found.gap.before)
    assert found.gap.before > 3.0 * found.gap.after
