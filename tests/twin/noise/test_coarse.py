"""A reading in coarse steps says an interval: what lies within is no error, and what lies beyond tells much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record
from twin.choose.rules import DecisionRules
from twin.choose.stages import judge
from twin.choose.weigh import Weights
from twin.choose.witness import driven_by_model, gauge_wanders, left_of_position
from twin.fit.case import Margin, make_case, widened
from twin.fit.fitting import Fit
from twin.fit.space import make_space
from twin.fit.trial import Trial
from twin.judge.verdict import pronounce
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.noise.coarse import Coarse, coarse, flicker
from twin.record.sensing import sense
from twin.search.score import make_yardstick, student_log_likelihood
from twin.search.search_rules import SearchRules

STEP_IN = 0.03
LATE = Inserted("additional_lag", effect("additional_lag").form("behind_stem"), (0.25,))


def rests(noise: float, seed: int, count: int = 400, rows: int = 100) -> tuple[np.ndarray, Recording]:
    """Where a stem stands, and what a converter of step 1 reads there."""
    dice = np.random.default_rng(seed)
    x = np.repeat(dice.uniform(0.0, 20.0, count), rows)
    read = np.round(x + noise * dice.normal(size=x.size))
    return x, Recording("rests", np.arange(x.size, dtype=float), np.zeros(x.size), read)


def rounded(record: Recording) -> Recording:
    return replace(record, position=STEP_IN * np.round(record.position / STEP_IN))


@pytest.mark.parametrize("noise", [0.02, 0.05, 0.1])
def test_noise_takes_a_reading_beyond_half_a_step_as_often_as_it_says(noise: float) -> None:
    x, read = rests(noise, 1, count=20_000, rows=10)
    beyond = np.maximum(np.abs(read.position - x) - 0.5, 0.0)
    still = Coarse(1.0, 0.0).beyond  # what a model that is right may miss besides
    assert np.mean(beyond**2) == pytest.approx(Coarse(1.0, noise).beyond ** 2 - still**2, rel=0.06)


@pytest.mark.parametrize("noise", [0.01, 0.05, 0.1])
def test_noise_shows_in_how_often_a_code_is_left_and_taken_again(noise: float) -> None:
    assert flicker([rests(noise, 2, count=4000)[1]], 1.0) == pytest.approx(noise, rel=0.2)


@settings(max_examples=20)
@given(st.floats(-0.3, 0.3))
def test_a_prediction_that_is_off_shows_at_the_edges(off: float) -> None:
    x, read = rests(0.0, 3, count=40_000, rows=1)
    beyond = np.maximum(np.abs(read.position - (x + off)) - 0.5, 0.0)
    assert np.mean(beyond**2) == pytest.approx(Coarse(1.0, 0.0).shifted(np.array([off])), rel=0.1, abs=1e-6)


def test_steps_that_noise_blurs_are_not_sharp() -> None:
    assert coarse([rests(0.3, 4)[1]], 1.0) is None
    assert coarse([rests(0.05, 4)[1]], 1.0) is not None
    assert coarse([rests(0.05, 4)[1]], 0.0) is None


def test_a_margin_of_the_healthy_machine_blurs_the_edges() -> None:
    case = make_case([rounded(a_record(Plant(DesignModel())))], DesignModel(), step=STEP_IN, sharp=True)
    wide, _ = widened(case, Margin(position=0.005))
    assert case.coarse is not None and wide.coarse is not None
    assert wide.coarse.beyond > 1.5 * case.coarse.beyond


@pytest.mark.thorough
def test_a_lag_a_tenth_of_a_step_large_is_found_and_none_where_there_is_none() -> None:
    for inserted in ((LATE,), ()):
        record = rounded(a_record(Plant(DesignModel(), inserted), twice=True))
        case = make_case([record], DesignModel(), step=STEP_IN, sharp=True)
        result = judge(case, SearchRules(most=1), DecisionRules(), lambda _w, _s: None)
        assert set(result.causes) <= {"additional_lag", "sensor_lag"}
        assert len(result.causes) == len(inserted)
        for one in result.plant().inserted:
            assert one.values[0] == pytest.approx(0.25, rel=0.05)


def test_errors_that_are_mostly_none_have_a_likelihood_of_a_size() -> None:
    """Twice as large errors are as likely as these, times 2 for each: no zero makes the scale vanish."""
    sparse = np.where(np.arange(2000) % 40 == 0, np.random.default_rng(5).normal(size=2000), 0.0)
    twice = student_log_likelihood(2.0 * sparse)
    assert student_log_likelihood(sparse) - twice == pytest.approx(2000 * np.log(2.0), rel=1e-3)


def test_readings_that_hold_what_is_predicted_vouch_for_no_scale() -> None:
    """Ten thousand of them make a hypothesis no likelier that leaves 2 % less of what few others are off."""
    rng = np.random.default_rng(7)
    best = np.where(np.arange(10_000) % 40 == 0, rng.standard_normal(10_000), 0.0)
    stick = make_yardstick(best, np.ones(10_000, dtype=bool))
    assert stick.square == pytest.approx(1.0, rel=0.2)

    def score(residuals: np.ndarray) -> float:
        space = make_space(Plant(DesignModel()), (), (), Scales())
        empty = np.zeros(0)
        return stick.score(Fit(space, empty, float(np.mean(residuals**2)), 0.0, residuals, np.zeros((0, 0)), 1))

    little_worse = 1.01 * best
    assert 0.0 < score(best) - score(little_worse) < 5.0
    assert student_log_likelihood(best) - student_log_likelihood(little_worse) > 50.0
    more_off = np.where(np.arange(10_000) % 20 == 0, rng.standard_normal(10_000), 0.0)
    assert score(best) - score(more_off) > 50.0
    assert make_yardstick(rng.standard_normal(10_000), np.ones(10_000, dtype=bool)).square == 0.0


def test_the_stem_is_heard_within_the_steps_of_its_reading() -> None:
    """Slow noise of a gauge moves a modelled stem by less than the steps, and beyond their edges all the same."""
    healthy = a_record(Plant(DesignModel()))
    slow = lfilter([1.0], [1.0, -0.99], np.random.default_rng(5).normal(0.0, 0.006, healthy.n))
    strays = replace(rounded(healthy), pressure=np.asarray(healthy.pressure) + slow)
    left = []
    for sharp in (True, False):
        case = make_case([strays], DesignModel(), step=STEP_IN, sharp=sharp)
        driven = case.trials[0].with_pressure(np.interp(*_fine(case.trials[0]), np.asarray(strays.pressure)))
        modelled = driven_by_model(case.base, case.trials)
        left.append(gauge_wanders(left_of_position(case, (driven,)), left_of_position(case, modelled)))
    assert left == [True, False]


@pytest.mark.parametrize(
    ("half", "mse", "verdict"),
    [
        pytest.param(0.005, 3.0, "no_gap", marks=pytest.mark.thorough),
        pytest.param(0.005, 5.0, "unexplained", marks=pytest.mark.thorough),
        pytest.param(0.03, 15.0, "no_gap", marks=pytest.mark.thorough),
        pytest.param(0.03, 150.0, "unexplained", marks=pytest.mark.thorough),
        pytest.param(0.0, 3.0, "unexplained", marks=pytest.mark.thorough),
    ],
)
def test_what_is_beyond_the_edges_by_a_little_is_no_gap(half: float, mse: float, verdict: str) -> None:
    """How much noise takes readings over an edge hardly shows in them: it does so with its cube."""
    record = a_record(Plant(DesignModel()))
    case = make_case([record], DesignModel())
    result = judge(case, SearchRules(most=1), DecisionRules(), lambda _w, _s: None)
    *others, last = result.decisions
    found = last.findings
    more = replace(found, channel=replace(found.channel, half=half), none=replace(found.none, mse=mse))
    missed = replace(last, findings=more, accepted=more.none, explained=False, gap=True)
    sensing = sense([record], case.noise, DesignModel())
    judgement = pronounce(replace(result, decisions=(*others, missed)), sensing, 0.0, Weights())
    assert judgement.verdict == verdict


def _fine(trial: Trial) -> tuple[np.ndarray, np.ndarray]:
    """Fine points and rows on one axis."""
    return np.arange(trial.grid.n_fine, dtype=float), trial.grid.offsets.astype(float)
