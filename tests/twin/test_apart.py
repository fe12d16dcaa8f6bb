"""A zero that each recording has of its own."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.trials import SIGMA, trial_of
from twin.case import make_case
from twin.catalog import effect
from twin.choose.candidates import effect_causes
from twin.diagnose import diagnose
from twin.effect import Coefficients, Place
from twin.fit.channel import position_channel, predict_reading
from twin.plant import Inserted, Plant
from twin.slots import KNOTS, S_DRIFT_RATE, S_ZERO

FORM = effect("lvdt_drift").form("apart")
VALUES = tuple(0.001 * k for k in range(1, KNOTS + 1))


def written(part: tuple[int, int] | None, duration_s: float = 100.0) -> Coefficients:
    return Plant(DesignModel(), (Inserted("lvdt_drift", FORM, VALUES),)).coefficients(duration_s, part and Place(*part))


def test_few_recordings_have_a_line_each_and_many_a_zero_each() -> None:
    c = written((1, 5))
    assert c.sensor[S_ZERO] == pytest.approx(0.003) and c.sensor[S_DRIFT_RATE] == pytest.approx(1e-5)
    c = written((7, 8))
    assert c.sensor[S_ZERO] == pytest.approx(0.008) and c.sensor[S_DRIFT_RATE] == 0.0


def test_a_part_of_a_recording_lies_on_the_line_of_the_whole() -> None:
    """A window of 20 s from 30 s on, of 100 s: the zero goes from 3 to 4 thousandths over all of it."""
    plant = Plant(DesignModel(), (Inserted("lvdt_drift", FORM, VALUES),))
    c = plant.coefficients(20.0, Place(1, 5, since_s=30.0, span_s=100.0, within_s=30.0, whole_s=100.0))
    assert c.sensor[S_ZERO] == pytest.approx(0.0033) and c.sensor[S_DRIFT_RATE] == pytest.approx(1e-5)


def test_the_zero_of_another_recording_is_not_known() -> None:
    c = written(None)
    assert c.sensor[S_ZERO] == c.sensor[S_DRIFT_RATE] == 0.0


def steps(seed: int) -> FloatArray:
    return np.repeat(np.random.default_rng(seed).uniform(5.5, 12.5, 15), 100)


def recordings(zeros: list[float]) -> list[Recording]:
    found = []
    for k, zero in enumerate(zeros):
        recording = trial_of(Plant(DesignModel()), steps(k // 2), seed=k)[0].recording
        found.append(
            Recording(f"r{k}", recording.time_s, recording.command, recording.position + zero, recording.pressure)
        )
    return found


def test_it_is_a_candidate_for_two_recordings_up_to_as_many_as_there_are_values() -> None:
    for count, there in ((1, False), (2, True), (KNOTS, True), (KNOTS + 1, False)):
        case = make_case(recordings([0.0] * count), DesignModel())
        causes = effect_causes(position_channel(case.trials, SIGMA))
        assert any(c.form is FORM for c in causes) is there


def test_each_recording_is_predicted_with_its_own_zero() -> None:
    case = make_case(recordings([0.0] * 4), DesignModel())
    plant = Plant(DesignModel(), (Inserted("lvdt_drift", FORM, VALUES),))
    for k, trial in enumerate(case.trials):
        moved = predict_reading(plant, trial) - predict_reading(Plant(DesignModel()), trial)
        assert moved[-1] == pytest.approx(VALUES[2 * k + 1], abs=2e-5)


def test_zeros_that_differ_between_recordings_are_a_drift() -> None:
    outcome = diagnose(recordings([0.0, 0.004, 0.004, -0.003]), DesignModel())
    assert [c.name for c in outcome.diagnosis.causes] == ["lvdt_drift"]
