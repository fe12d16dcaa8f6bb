from __future__ import annotations

import pytest

from app.blind.mark import mark
from tests.app.blind.lines import label, said


def test_all_true_causes_and_no_other_is_right() -> None:
    found = mark(label("effects", "creep", "dead_time"), said("effects", ("dead_time", 0.9), ("creep", 0.8)))
    assert found.right and found.leading and found.found == 2 and not found.false
    assert found.ranks == (2, 1)
    assert found.claims == ((0.9, True), (0.8, True))


def test_one_cause_too_many_is_wrong_but_leads() -> None:
    found = mark(label("effect", "creep"), said("effects", ("creep", 0.9), ("stiction", 0.5)))
    assert not found.right and found.leading
    assert found.false == ("stiction",) and found.astray == ("stiction",)


def test_a_confusion_set_covers_what_was_not_named() -> None:
    answer = said("effect", ("sensor_lag", 0.6), confusable=(("sensor_lag", "additional_lag", "creep"),))
    found = mark(label("effect", "creep"), answer)
    assert not found.right and not found.leading
    assert (found.found, found.covered, found.set_sizes) == (0, 1, (3,))
    assert found.false == ("sensor_lag",) and not found.astray


def test_a_set_around_a_name_that_was_not_given_does_not_count() -> None:
    found = mark(label("effect", "creep"), said("effect", ("stiction", 0.6), confusable=(("sensor_lag", "creep"),)))
    assert found.covered == 0 and found.set_sizes == (1,)


@pytest.mark.parametrize(
    ("kind", "verdict", "right"),
    [
        ("none", "no_gap", True),
        ("none", "unexplained", False),
        ("outsider", "unexplained", True),
        ("outsider", "no_gap", False),
    ],
)
def test_valves_without_a_nameable_cause(kind: str, verdict: str, right: bool) -> None:
    found = mark(label(kind, *(["snap_region"] if kind == "outsider" else [])), said(verdict))
    assert found.right is right and found.leading is right


def test_a_name_given_to_an_outsider_is_false_even_if_it_were_its_own() -> None:
    found = mark(label("outsider", "snap_region"), said("effect", ("snap_region", 0.9)))
    assert not found.right and found.false == ("snap_region",)


def test_stages_by_name_and_by_the_signals() -> None:
    found = mark(label("effect", "dead_time"), said("effect", ("sensor_lag", 0.9)))
    assert found.stage is False and found.signal_stage is True
    both = mark(label("effects", "dead_time", "creep"), said("effect", ("creep", 0.9)))
    assert both.stage is True and both.signal_stage is None
