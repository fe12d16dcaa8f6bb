"""Whole conditions held out: repeats stay together, one condition gives no answer, and a true cause carries over."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record
from twin.choose.rules import DecisionRules
from twin.choose.stages import StageResult, judge
from twin.diagnosis import Gap
from twin.fit.case import make_case
from twin.judge.by_condition import gap_by_condition
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.ready import thin
from twin.ready.tuned import retuned_fit
from twin.search.search_rules import SearchRules

CREEP = Plant(DesignModel(), (Inserted("creep", effect("creep").form("one_tail"), (0.1, 20.0)),))
FLOOR_IN = 0.0004


def halves(record: Recording) -> list[Recording]:
    return [record.slice(0, record.n // 2), record.slice(record.n // 2, record.n)]


def searched(recordings: list[Recording]) -> StageResult:
    look, _ = thin.look_at(make_case(recordings, DesignModel(), ()))
    return judge(look, SearchRules(most=1), DecisionRules(), lambda _what, _share: None)


def unsearched(recordings: list[Recording]) -> StageResult:
    case = make_case(recordings, DesignModel(), ())
    return StageResult(case, (), case.trials)


def apart(result: StageResult) -> Gap | None:
    return gap_by_condition(result, retuned_fit(result.case), FLOOR_IN)


@pytest.fixture(scope="module")
def creeping() -> StageResult:
    return searched(halves(a_record(CREEP, n=2400)))


@pytest.mark.thorough
def test_a_true_cause_carries_over_to_commands_that_no_fit_has_met(creeping: StageResult) -> None:
    found = apart(creeping)
    assert found is not None
    assert found.after < 0.2 * found.before  # what the stem remembers at the cut, nobody knows
    assert found.retuned > 3.0 * found.after
    assert found.reducible_closed is not None and found.reducible_closed.value > 0.95


@pytest.mark.thorough
def test_a_floor_with_motion_in_it_is_as_doubtful_here_as_elsewhere(creeping: StageResult) -> None:
    def width(source: str) -> float:
        noise = creeping.case.noise
        case = replace(creeping.case, noise=replace(noise, position=replace(noise.position, source=source)))
        found = gap_by_condition(replace(creeping, case=case), retuned_fit(case), 20.0 * FLOOR_IN)
        assert found is not None and found.reducible_closed is not None
        return float(np.ptp(found.reducible_closed.ci95))

    assert width("straight") > 1.2 * width("still")


@pytest.mark.thorough
def test_what_was_judged_on_a_look_predicts_all_rows(monkeypatch: pytest.MonkeyPatch, creeping: StageResult) -> None:
    monkeypatch.setattr(thin, "MOST_ROWS", 2000)
    monkeypatch.setattr(thin, "LOOK_ROWS", 1800)
    result = searched(halves(a_record(CREEP, n=2400)))
    assert result.case.everything is not result.case
    found, whole = apart(result), apart(creeping)
    assert found is not None and whole is not None
    assert found.before == pytest.approx(whole.before)
    assert found.after == pytest.approx(whole.after, rel=0.2)


def test_repeats_are_one_condition_and_one_condition_gives_no_answer() -> None:
    once, again = halves(a_record(CREEP, twice=True, n=2400))
    again = replace(again, time_s=again.time_s - again.time_s[0] + once.time_s[0])
    assert apart(unsearched([once, again])) is None
    other = a_record(CREEP, seed=3, n=2400)
    assert apart(unsearched([once, again, replace(other, command=17.0 - other.command[::-1])])) is not None


@pytest.mark.thorough
def test_any_number_of_repeats_is_one_condition() -> None:
    short = a_record(Plant(DesignModel())).slice(0, 300)
    noise = np.random.default_rng(4).normal(0.0, FLOOR_IN, (45, short.n))
    assert apart(unsearched([replace(short, position=short.position + one) for one in noise])) is None
