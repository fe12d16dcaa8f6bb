"""A running mean against its closed forms, at once and block by block."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from twin.kernels.mean import running_mean
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.mean import Mean

TIME_S = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.04, 800))


def test_a_step_becomes_a_ramp_and_a_ramp_comes_half_a_window_late() -> None:
    step = np.where(TIME_S >= 10.0, 1.0, 0.0)
    got = running_mean(TIME_S, step, 2.0)
    assert np.max(np.abs(got - np.clip((TIME_S - 10.0) / 2.0, 0.0, 1.0))) < 0.02
    late = running_mean(TIME_S, 3.0 * TIME_S, 2.0)
    np.testing.assert_allclose(late[TIME_S > 2.1], 3.0 * (TIME_S[TIME_S > 2.1] - 1.0), rtol=1e-9)


def test_before_the_first_point_it_was_as_it_is_there() -> None:
    np.testing.assert_allclose(running_mean(TIME_S, np.full(TIME_S.size, 0.7), 5.0), 0.7)
    ramp = TIME_S - TIME_S[0]
    inside = ramp < 5.0
    np.testing.assert_allclose(running_mean(TIME_S, ramp, 5.0)[inside], ramp[inside] ** 2 / 10.0, atol=1e-9)


@pytest.mark.parametrize("window_s", [0.0, 1e-12, 1e-6, 1e-4])
def test_a_window_of_next_to_nothing_leaves_the_signal(window_s: float) -> None:
    signal = 0.5 + 0.2 * np.sin(TIME_S)
    np.testing.assert_allclose(running_mean(TIME_S, signal, window_s), signal, atol=1e-4 * 0.2)


@given(window_s=st.floats(0.01, 30.0), seed=st.integers(0, 1000))
def test_block_by_block_it_is_the_same(window_s: float, seed: int) -> None:
    dice = np.random.default_rng(seed)
    values = dice.normal(size=TIME_S.size).cumsum()
    mean, got = Mean(window_s), [values[0]]
    ends = np.unique(np.concatenate([[0, TIME_S.size - 1], dice.integers(1, TIME_S.size - 1, 60)]))
    for a, b in pairwise(ends):
        got += mean.follow(TIME_S[a : b + 1], values[a : b + 1])[1:].tolist()
    np.testing.assert_allclose(got, running_mean(TIME_S, values, window_s), atol=1e-7 * np.abs(values).max() + 1e-9)


def test_the_live_mean_forgets_what_it_no_longer_needs() -> None:
    mean = Mean(0.5)
    for k in range(TIME_S.size - 1):
        mean.follow(TIME_S[k : k + 2], np.ones(2))
    assert mean._t.size < 60


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["running_mean", "running_mean_twice"])
def test_an_averaged_reading_is_a_lag_of_the_sensor(form: str) -> None:
    one = Inserted("sensor_lag", effect("sensor_lag").form(form), (0.6,))
    result, judgement = judged(a_record(Plant(DesignModel(), (one,))))
    assert [c.name for c in judgement.causes] == ["sensor_lag"]
    [found] = [i for i in result.plant().inserted if i.effect == "sensor_lag"]
    assert found.form.name == form and found.values[0] == pytest.approx(0.6, rel=0.03)
