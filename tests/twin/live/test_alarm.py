"""The alarm keeps its promises: false alarms as rare as stated, shifts noticed as soon as stated."""

from __future__ import annotations

import math

import numpy as np
import pytest

from logs.recording import FloatArray
from twin.live.alarm import AlarmRules, Cusum, CusumState, design_cusum, limit_for, run_length


def noise(n: int, sigma: float, phi: float, seed: int) -> FloatArray:
    """First-order noise of standard deviation `sigma`, in its steady state."""
    chance = np.random.default_rng(seed).standard_normal(n)
    out = np.empty(n)
    out[0] = sigma * chance[0]
    for k in range(1, n):
        out[k] = phi * out[k - 1] + sigma * math.sqrt(1.0 - phi**2) * chance[k]
    return out


def alarms(cusum: Cusum, residuals: FloatArray) -> list[int]:
    """Where it alarms when it begins anew after each alarm."""
    state, found = CusumState(), []
    for k, value in enumerate(residuals.tolist()):
        state = cusum.step(state, value, float(k))
        if abs(cusum.statistic(state)) >= 1.0:
            found.append(k)
            state = CusumState(last=value)
    return found


@pytest.mark.parametrize(
    ("reference", "limit", "published"), [(0.5, 4.0, 168.0), (0.5, 5.0, 465.0), (0.25, 8.0, 368.0)]
)
def test_run_length_agrees_with_published_tables(reference: float, limit: float, published: float) -> None:
    """Two-sided run lengths: Montgomery, Introduction to Statistical Quality Control, tables of the tabular CUSUM."""
    assert run_length(limit, reference) == pytest.approx(published, rel=0.03)


def test_limit_is_the_inverse_of_the_run_length() -> None:
    assert run_length(limit_for(0.3, 5000.0), 0.3) == pytest.approx(5000.0, rel=1e-6)


@pytest.mark.parametrize("phi", [0.0, 0.6])
def test_false_alarms_come_as_often_as_stated_where_noise_decides(phi: float) -> None:
    rules = AlarmRules(within_s=1.0, false_alarm_s=1000.0)
    cusum = design_cusum(shift=1.0 * math.sqrt((1 + phi) / (1 - phi)), sigma=1.0, phi=phi, period_s=1.0, rules=rules)
    assert cusum.reference == pytest.approx(0.5)
    found = alarms(cusum, noise(250_000, 1.0, phi, seed=1))
    assert 250_000 / len(found) == pytest.approx(1000.0, rel=0.2)


def test_false_alarms_are_rarer_than_stated_where_noise_is_small() -> None:
    cusum = design_cusum(0.01, 0.0006, 0.2, 0.1, AlarmRules(false_alarm_s=100.0))
    assert alarms(cusum, noise(50_000, 0.0006, 0.2, seed=2)) == []


def test_the_smallest_shift_is_noticed_as_soon_as_stated() -> None:
    cusum = design_cusum(0.01, 0.0006, 0.2, 0.1, AlarmRules(within_s=5.0))
    assert cusum.delay_s == pytest.approx(5.0, rel=0.05)
    found = alarms(cusum, 0.01 + noise(200, 0.0006, 0.2, seed=3))
    assert 0.1 * found[0] == pytest.approx(5.0, rel=0.15)
    down = alarms(cusum, -0.01 + noise(200, 0.0006, 0.2, seed=3))
    assert 0.1 * down[0] == pytest.approx(5.0, rel=0.15)


@pytest.mark.parametrize(("sigma", "forgiven"), [(0.0012, 0.0095), (0.01, 0.0085), (0.02, 0.005), (0.05, 0.0)])
def test_the_louder_the_noise_the_smaller_the_model_error_that_is_forgiven(sigma: float, forgiven: float) -> None:
    cusum = design_cusum(0.02, sigma, 0.0, 0.1, AlarmRules())
    assert cusum.forgives == pytest.approx(forgiven, abs=5e-4)


@pytest.mark.parametrize("phi", [0.0, 0.6])
def test_a_model_error_that_is_forgiven_brings_no_more_false_alarms_than_stated(phi: float) -> None:
    rules = AlarmRules(within_s=20.0, false_alarm_s=5000.0)
    cusum = design_cusum(2.0, 1.0, phi, 1.0, rules)
    assert 0.1 < cusum.forgives < 0.9
    found = alarms(cusum, cusum.forgives + noise(200_000, 1.0, phi, seed=4))
    assert len(found) < 2.0 * 200_000 / 5000.0
    assert len(alarms(cusum, 1.0 + noise(20_000, 1.0, phi, seed=4))) > 4.0 * 20_000 / 5000.0


def test_statistic_has_the_sign_of_the_shift_and_a_missing_reading_holds_it() -> None:
    cusum = design_cusum(0.01, 0.0006, 0.0, 0.1, AlarmRules())
    state = CusumState()
    for k in range(20):
        state = cusum.step(state, -0.02, 0.1 * k)
    before = cusum.statistic(state)
    assert before < 0.0
    held = cusum.step(state, math.nan, 2.0)
    assert cusum.statistic(held) == before
    assert cusum.step(held, -0.02, 2.1).low > state.low
