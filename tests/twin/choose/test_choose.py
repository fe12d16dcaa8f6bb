"""Search, score and decision: every effect is found when it is large, and nothing where there is nothing.

The truth is simulated with the candidates' own code here, so this says that the machinery is sound and no more; what
the diagnosis is worth is measured on other physics (docs/blind.md).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import a_record, judged
from twin.choose.weigh import Weights, weigh
from twin.explain import typical_values
from twin.fit.least_squares import descend, minimise
from twin.model.catalog import effects
from twin.model.effect import Effect
from twin.model.plant import Inserted, Plant
from twin.search.score import inflation, make_yardstick, student_log_likelihood, whitening_filter

#: One that is tried each time; the others take seconds each.
QUICK = "nonlinear_spring"


@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(e, id=e.name, marks=() if e.name == QUICK else pytest.mark.thorough)
        for e in effects().values()
        if e.evidence == "trajectory"
    ],
)
def test_a_large_effect_is_named(effect: Effect) -> None:
    form = effect.forms[0]
    record = a_record(Plant(DesignModel(), (Inserted(effect.name, form, tuple(typical_values(form))),)))
    _, judgement = judged(record)
    named = {cause.name for cause in judgement.causes}
    twins = {name for names in effect.same_as.values() for name in names}
    assert named & {effect.name, *twins}, f"{effect.name} came out as {judgement.verdict} {sorted(named)}"


def test_nothing_is_named_where_nothing_is_wrong() -> None:
    _, judgement = judged(a_record(Plant(DesignModel())))
    assert judgement.verdict == "no_gap"
    assert judgement.causes == ()


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("number", "design"),
    [
        ("deadband", DesignModel(a1=8.9, a2=5.7)),
        ("tau", DesignModel(tau_s=3.1)),
        ("rate_limit", DesignModel(rate_limit=0.1)),
        ("ep_tau", DesignModel(ep_tau_s=0.45)),
    ],
)
def test_a_wrong_design_number_is_not_called_an_effect(number: str, design: DesignModel) -> None:
    _, judgement = judged(a_record(Plant(design)))
    assert judgement.verdict == "parameter"
    assert [cause.name for cause in judgement.causes] == [f"parameter:{number}"]


@pytest.mark.thorough
def test_something_outside_the_vocabulary_is_unexplained() -> None:
    record = a_record(Plant(DesignModel()))
    wave = 0.02 * np.sin(2.0 * np.pi * record.time_s / 23.0)
    position = record.position + wave
    _, judgement = judged(Recording("wave", record.time_s, record.command, position, record.pressure))
    assert judgement.verdict == "unexplained"
    assert judgement.causes == ()


@pytest.mark.thorough
def test_probabilities_stay_within_their_ceiling_and_twins_below_theirs() -> None:
    effect = effects()["sensor_lag"]
    plant = Plant(DesignModel(), (Inserted(effect.name, effect.forms[0], tuple(typical_values(effect.forms[0]))),))
    _, judgement = judged(a_record(plant))
    weights = Weights()
    assert all(cause.probability <= weights.exact for cause in judgement.causes)
    assert {"sensor_lag", "additional_lag"} <= {name for names in judgement.confusable for name in names}
    lag = next(c for c in judgement.causes if c.name in ("sensor_lag", "additional_lag"))
    assert lag.probability <= weights.twin_ceiling


@pytest.mark.thorough
def test_what_leaves_more_than_the_noise_is_less_sure() -> None:
    """The same cause on the same record, once with nothing left of it and once with a fifth of the noise besides.

    A large cause: of a small one a friction that is free at thirteen places leaves as little.
    """
    effect = effects()["spring_asymmetry"]
    plant = Plant(DesignModel(), (Inserted(effect.name, effect.forms[0], (0.2,)),))
    decision = judged(a_record(plant))[0].decisions[-1]
    assert decision.names == ("spring_asymmetry",)
    weights = Weights()
    worse = replace(decision, floor=decision.accepted.mse / 1.2)
    assert weigh(decision, weights).probability["spring_asymmetry"] == weights.exact
    assert weigh(worse, weights).probability["spring_asymmetry"] == weights.ceiling


def test_whitening_takes_the_memory_out() -> None:
    dice = np.random.default_rng(0)
    noise = dice.normal(size=20_000)
    memory = np.empty_like(noise)
    memory[0] = noise[0]
    for k in range(1, noise.size):
        memory[k] = 0.9 * memory[k - 1] + noise[k]
    fir = whitening_filter(memory)
    assert fir[1] == pytest.approx(-0.9, abs=0.03)
    yardstick = make_yardstick(memory, np.ones(memory.size, dtype=bool))
    assert yardstick.phi > 10.0
    assert yardstick.white_phi < 1.2


def test_the_autocorrelation_does_not_wrap_around() -> None:
    """A residual that is slow at its ends, and as a circle would go on."""
    residuals = np.random.default_rng(0).normal(size=1009)  # a prime: rounded up for the transform
    residuals[:100] += 3.0
    residuals[-100:] += 3.0
    r = residuals - residuals.mean()
    acf = np.correlate(r, r, "full")[r.size - 1 :][: r.size // 8] / (r @ r)
    pairs = acf[1::2][: acf.size // 2 - 1] + acf[2::2][: acf.size // 2 - 1]
    last = int(np.argmax(pairs <= 0.0)) if (pairs <= 0.0).any() else pairs.size
    expected = np.clip(1.0 + 2.0 * np.sum(pairs[:last]), 1.0, r.size / 16.0)
    assert inflation(residuals, np.ones(r.size, dtype=bool)) == pytest.approx(expected, rel=1e-9)


def test_student_likelihood_forgives_a_few_outliers() -> None:
    dice = np.random.default_rng(0)
    clean = dice.normal(size=5000)
    spoilt = clean.copy()
    spoilt[::500] = 60.0
    louder = 2.0 * clean
    assert student_log_likelihood(clean) > student_log_likelihood(spoilt) > student_log_likelihood(louder)


def test_least_squares_finds_the_minimum_and_keeps_the_bounds() -> None:
    x = np.linspace(0.0, 1.0, 50)

    def residuals(z: FloatArray) -> FloatArray:
        return np.asarray(z[0] * np.exp(-z[1] * x) - 2.0 * np.exp(-3.0 * x))

    low, high, steps = np.array([0.0, 0.0]), np.array([5.0, 10.0]), np.array([1e-4, 1e-4])
    free = minimise(residuals, np.array([1.0, 1.0]), low, high, steps, rounds=30)
    assert free.z == pytest.approx([2.0, 3.0], abs=1e-3)
    held = minimise(residuals, np.array([1.0, 1.0]), low, np.array([5.0, 2.0]), steps, rounds=30)
    assert held.z[1] == pytest.approx(2.0, abs=1e-9)


def test_descent_walks_into_a_narrow_valley() -> None:
    def residuals(z: FloatArray) -> FloatArray:
        return np.array([0.1 if abs(z[0] - 0.3) < 0.01 else 1.0 + abs(z[0] - 0.3)])

    z = descend(residuals, np.array([0.33]), np.array([0]), np.array([0.0]), np.array([1.0]))
    assert abs(z[0] - 0.3) < 0.01
