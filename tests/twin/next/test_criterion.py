"""The criterion measures what two explanations could be told apart by, and the experiments keep what it promises."""

from __future__ import annotations

import numpy as np
import pytest

from control.experiment_catalog import make_experiment
from tests.twin.next.two_lags import SIGMA, TRUTH, dispute, fitted, record, recorded, result
from twin.fit.case import make_case
from twin.fit.channel import chain_channel
from twin.next.criterion import Scale, bound, distance, lay_out, predict, refitted
from twin.replay.simulate import Start, simulate_recording

EXPERIMENT = make_experiment("random", {"count": 20, "dwell_max_s": 4.0, "seed": 3})
SCALE = Scale("chain", SIGMA, 0.1)


def test_predicts_what_the_simulation_of_the_experiment_says() -> None:
    bed = lay_out(EXPERIMENT, 1.0, rows_s=0.1, step_s=0.02)
    made = recorded(TRUTH, EXPERIMENT)
    _, whole = simulate_recording(TRUTH, made, start=Start(made.command[0], 0.0, 0.0))
    assert np.max(np.abs(predict(TRUTH, bed, "chain") - whole)) < 1e-5


def test_an_explanation_is_no_distance_from_itself() -> None:
    one = dispute("dead_time", "sensor_lag").accepted
    assert distance(one, one, lay_out(EXPERIMENT, 1.0), SCALE).gain == pytest.approx(0.0, abs=1e-9)


def test_refitting_hides_some_of_the_difference_and_never_adds_to_it() -> None:
    found = dispute("dead_time", "sensor_lag")
    a, b = found.accepted, found.rivals[0]
    bed = lay_out(EXPERIMENT, 1.0)
    free, hidden = bound(a.plant(), b.plant(), bed, SCALE), distance(a, b, bed, SCALE)
    assert 0.0 < hidden.squared < free.squared
    assert hidden.squared == pytest.approx(distance(b, a, bed, SCALE).squared, rel=1e-6)


def test_a_rival_that_is_really_fitted_again_comes_as_close_as_the_linear_criterion_says() -> None:
    found = dispute("dead_time", "sensor_lag")
    a, b, bed = found.accepted, found.rivals[0], lay_out(EXPERIMENT, 1.0)
    again = refitted(a, b, bed, SCALE)
    assert again.squared < bound(a.plant(), b.plant(), bed, SCALE).squared
    assert again.squared == pytest.approx(distance(a, b, bed, SCALE).squared, rel=0.5)
    assert refitted(a, a, bed, SCALE).squared == pytest.approx(0.0, abs=1e-9)


def test_noise_divides_the_distance_and_correlation_its_worth() -> None:
    found = dispute("dead_time", "sensor_lag")
    a, b, bed = found.accepted.plant(), found.rivals[0].plant(), lay_out(EXPERIMENT, 1.0)
    plain = bound(a, b, bed, SCALE)
    assert bound(a, b, bed, Scale("chain", 2.0 * SIGMA, 0.1)).squared == pytest.approx(plain.squared / 4.0)
    slow = bound(a, b, bed, Scale("chain", SIGMA, 0.4))
    assert slow.worth == pytest.approx(plain.worth / 4.0)
    assert slow.gain == pytest.approx(plain.gain / 4.0)


def test_the_experiment_brings_the_evidence_that_was_expected_of_it() -> None:
    """Both explanations are fitted again to the record and the experiment together, made by the true valve."""
    found = dispute("dead_time", "sensor_lag")
    causes = [f.space.causes[0] for f in result("dead_time", "sensor_lag").decisions[0].findings.fits]
    expected = distance(found.accepted, found.rivals[0], lay_out(EXPERIMENT, 1.0), SCALE).gain
    both = make_case(
        [record(), recorded(TRUTH, EXPERIMENT, seed=8)], result("dead_time", "sensor_lag").case.base.design
    )
    channel = chain_channel(both.trials, SIGMA)
    true, false = (fitted(both, channel, cause) for cause in causes)
    old = result("dead_time", "sensor_lag").decisions[0].findings.fits
    rows_before = record().n
    gained = 0.5 * (channel.rows * (false.mse - true.mse) - rows_before * (old[1].mse - old[0].mse))
    assert expected > 20.0
    assert 0.5 * expected < gained < 2.0 * expected
