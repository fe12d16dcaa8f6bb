"""Whole conditions held out: repeats stay together, one condition gives no answer, and a true cause carries over."""

from __future__ import annotations

from dataclasses import replace

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record
from twin.by_condition import gap_by_condition
from twin.case import make_case
from twin.catalog import effect
from twin.choose.decide import DecisionRules
from twin.choose.search import SearchRules
from twin.plant import Inserted, Plant
from twin.stages import StageResult, judge
from twin.tuned import retuned_fit

CREEP = Plant(DesignModel(), (Inserted("creep", effect("creep").form("one_tail"), (0.1, 20.0)),))


def halves(record: Recording) -> list[Recording]:
    return [record.slice(0, record.n // 2), record.slice(record.n // 2, record.n)]


def searched(recordings: list[Recording]) -> StageResult:
    case = make_case(recordings, DesignModel(), ())
    return judge(case, SearchRules(most=1), DecisionRules(), lambda _what, _share: None)


def test_a_true_cause_carries_over_to_commands_that_no_fit_has_met() -> None:
    result = searched(halves(a_record(CREEP)))
    found = gap_by_condition(result.case, result, retuned_fit(result.case), result.case.sigma_y, 0)
    assert found is not None
    assert found.after < 0.2 * found.before  # what the stem remembers at the cut, nobody knows
    assert found.retuned > 3.0 * found.after
    assert found.reducible_closed is not None and found.reducible_closed.value > 0.95


def test_repeats_are_one_condition_and_one_condition_gives_no_answer() -> None:
    once, again = halves(a_record(CREEP, twice=True))
    again = replace(again, time_s=again.time_s - again.time_s[0] + once.time_s[0])
    result = searched([once, again])
    assert gap_by_condition(result.case, result, retuned_fit(result.case), result.case.sigma_y, 0) is None
    other = a_record(CREEP, seed=3)
    three = searched([once, again, replace(other, command=17.0 - other.command[::-1])])
    assert gap_by_condition(three.case, three, retuned_fit(three.case), three.case.sigma_y, 0) is not None
