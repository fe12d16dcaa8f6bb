"""A converter that refreshes by its own clock shows in which rows it did, and so when each reading was taken."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.judged import a_record
from twin.choose.rules import DecisionRules
from twin.choose.stages import judge
from twin.choose.weigh import Weights
from twin.events.clock import clock_of
from twin.events.refresh import freshness
from twin.fit.case import make_case
from twin.judge.verdict import pronounce
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.record.sensing import sense
from twin.replay.simulate import simulate_recording
from twin.search.search_rules import SearchRules


def rows(count: int, row_s: float, jitter: float, dice: np.random.Generator) -> FloatArray:
    """Times of rows that come unevenly."""
    return row_s * (np.arange(count) + jitter * dice.uniform(-0.5, 0.5, count))


def taken(t: FloatArray, period_s: float, phase_s: float) -> FloatArray:
    """The refresh before each row."""
    return np.asarray(phase_s + period_s * np.floor((t - phase_s) / period_s + 1e-9))


@pytest.mark.thorough
@settings(max_examples=40, deadline=None)
@given(st.integers(2, 9), st.floats(0.0, 1.0), st.floats(0.0, 0.4), st.integers(0, 2**32 - 1))
def test_it_knows_when_each_reading_was_taken(slower: int, phase: float, jitter: float, seed: int) -> None:
    """At periods that have no rhythm in common with the rows: in step with them, a reading is as old as its row."""
    dice = np.random.default_rng(seed)
    t = rows(3000, 0.1, jitter, dice)
    t -= t[0]
    period_s = 0.1 * (slower + 0.618)
    true_s = taken(t, period_s, phase * period_s)
    _, fresh = np.unique(true_s, return_inverse=True)
    clock = clock_of(t, dice.normal(size=t.size)[fresh])
    assert clock is not None
    assert clock.period_s == pytest.approx(period_s, rel=1e-3)
    late_s = clock.taken_s(t) - true_s
    agrees = np.abs(late_s - 0.5 * clock.slack_s) <= 0.5 * clock.slack_s + 0.01 * period_s
    assert agrees.mean() > 0.97


@pytest.mark.parametrize(("slower", "jitter"), [(1.5, 0.203125), (1.5, 0.3), (4.0, 0.2)])
def test_a_rhythm_in_common_with_uneven_rows_is_found(slower: float, jitter: float) -> None:
    dice = np.random.default_rng(0)
    t = rows(3000, 0.1, jitter, dice)
    _, fresh = np.unique(taken(t, 0.1 * slower, 0.035), return_inverse=True)
    clock = clock_of(t, dice.normal(size=t.size)[fresh])
    assert clock is not None and clock.period_s == pytest.approx(0.1 * slower, rel=1e-4)


@pytest.mark.parametrize("chance", [0.3, 0.6, 0.9])
def test_polls_that_repeat_at_random_follow_no_clock(chance: float) -> None:
    dice = np.random.default_rng(3)
    t = rows(3000, 0.1, 0.2, dice)
    held = np.maximum.accumulate(np.where(dice.random(t.size) > chance, np.arange(t.size), 0))
    assert clock_of(t, dice.normal(size=t.size)[held]) is None


def test_readings_that_are_all_new_follow_no_clock() -> None:
    dice = np.random.default_rng(4)
    assert clock_of(rows(3000, 0.1, 0.2, dice), dice.normal(size=3000)) is None


def test_a_replay_by_the_clock_reads_what_was_taken_between_the_rows() -> None:
    plain = a_record(Plant(DesignModel()), twice=False)
    t = plain.time_s - plain.time_s[0]
    true_s = np.maximum(taken(t, 0.8838, 0.31), 0.0)
    _, exact = simulate_recording(DesignModel(), plain)
    stale = replace(plain, position=np.interp(true_s, t, exact))
    form = effect("stale_samples").form
    errors = {}
    for name, values in (("as_seen", ()), ("own_clock", (0.5,))):
        _, again = simulate_recording(Plant(DesignModel(), (Inserted("stale_samples", form(name), values),)), stale)
        errors[name] = float(np.std(again - stale.position))
    assert errors["own_clock"] < 0.3 * errors["as_seen"]


def test_part_of_the_rows_keeps_what_is_known_of_them() -> None:
    record = a_record(Plant(DesignModel()), twice=False)
    t = record.time_s - record.time_s[0]
    whole = freshness(replace(record, position=np.interp(taken(t, 0.8838, 0.31), t, record.position)))
    some = np.arange(200, record.n, 3)
    part = whole.kept(some, record.time_s)
    np.testing.assert_allclose(part.taken_s + t[200], whole.taken_s[some])
    assert np.all(part.rows <= np.arange(some.size))
    assert np.all(np.diff(part.rows) >= 0)


@pytest.mark.thorough
def test_the_answer_gives_the_period_of_the_clock_and_what_was_fitted() -> None:
    record = a_record(Plant(DesignModel()), n=2400)
    t = record.time_s - record.time_s[0]
    stale = replace(record, position=np.interp(np.maximum(taken(t, 0.8838, 0.31), 0.0), t, record.position))
    case = make_case([stale], DesignModel(), held=True)
    result = judge(case, SearchRules(most=1), DecisionRules(), lambda _w, _s: None)
    sensing = sense([stale], case.noise, DesignModel())
    [cause] = pronounce(result, sensing, 0.0, Weights()).causes
    assert cause.name == "stale_samples"
    assert cause.parameters["period"].value == pytest.approx(0.8838, rel=1e-3)
    # readings of their own period, or of one that is read off them: as good as each other here
    assert {"early", "phase"} & set(cause.parameters)
