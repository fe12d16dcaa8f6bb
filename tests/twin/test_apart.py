"""A zero that each recording has of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import SIGMA, trial_of
from twin.diagnose import diagnose
from twin.fit.case import make_case
from twin.fit.channel import position_channel, predict_reading
from twin.kernels.sensor_slots import KNOTS
from twin.model.catalog import effect
from twin.model.coefficients import Coefficients
from twin.model.place import Place
from twin.model.plant import Inserted, Plant, reading_response
from twin.model.timegrid import make_grid
from twin.search.candidates import effect_causes

FORM = effect("lvdt_drift").form("apart")
VALUES = tuple(0.001 * k for k in range(1, KNOTS + 1))


def written(part: tuple[int, int] | None, duration_s: float = 100.0) -> Coefficients:
    return Plant(DesignModel(), (Inserted("lvdt_drift", FORM, VALUES),)).coefficients(duration_s, part and Place(*part))


def zeros(c: Coefficients, at_s: list[float], duration_s: float = 100.0) -> FloatArray:
    """What the reading of a stem at rest is off, at times in the recording."""
    grid = make_grid(np.linspace(0.0, duration_s, 501), 0.1)
    off = reading_response(c, grid, np.full(grid.n_fine, 0.2), np.zeros(grid.n_fine)) - 0.2
    return np.interp(at_s, grid.time_s, off)


def test_few_recordings_have_a_curve_each_and_many_a_zero_each() -> None:
    assert zeros(written((1, 2)), [0.0, 25.0, 50.0, 75.0, 100.0]) == pytest.approx(np.array(VALUES[5:]), abs=1e-6)
    assert zeros(written((1, 3)), [0.0, 50.0, 100.0]) == pytest.approx([0.004, 0.005, 0.006], abs=1e-6)
    assert zeros(written((1, 5)), [0.0, 30.0, 100.0]) == pytest.approx([0.003, 0.0033, 0.004], abs=1e-6)
    assert zeros(written((7, 8)), [0.0, 100.0]) == pytest.approx([0.008, 0.008], abs=1e-9)


def test_a_curve_is_a_curve() -> None:
    """Five values that go there and come back; between them it is smooth."""
    values = (0.0, 0.006, 0.008, 0.006, 0.0, *np.zeros(KNOTS - 5))
    c = Plant(DesignModel(), (Inserted("lvdt_drift", FORM, values),)).coefficients(100.0, Place(0, 2))
    got = zeros(c, [0.0, 12.5, 25.0, 50.0, 87.5])
    assert got == pytest.approx([0.0, 0.0035, 0.006, 0.008, 0.0035], abs=5e-5)


def test_a_part_of_a_recording_lies_on_the_curve_of_the_whole() -> None:
    """A window of 20 s from 30 s on, of 100 s."""
    values = (0.0, 0.006, 0.008, 0.006, 0.0, *np.zeros(KNOTS - 5))
    plant = Plant(DesignModel(), (Inserted("lvdt_drift", FORM, values),))
    whole = zeros(plant.coefficients(100.0, Place(0, 2)), [30.0, 40.0, 50.0])
    part = plant.coefficients(20.0, Place(0, 2, since_s=30.0, span_s=100.0, within_s=30.0, whole_s=100.0))
    assert zeros(part, [0.0, 10.0, 20.0], 20.0) == pytest.approx(whole, abs=2e-5)


def test_the_zero_of_another_recording_is_not_known() -> None:
    c = written(None)
    assert zeros(c, [0.0, 100.0]) == pytest.approx([0.0, 0.0], abs=1e-12)


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


@pytest.mark.thorough
def test_zeros_that_wander_in_each_recording_by_itself_are_a_drift() -> None:
    found = recordings([0.0, 0.0])
    curves = [0.006 * np.sin(np.pi * r.time_s / r.duration_s) ** p for r, p in zip(found, (1, 3), strict=True)]
    wandering = [replace(r, position=r.position + c) for r, c in zip(found, curves, strict=True)]
    outcome = diagnose(wandering, DesignModel(), (), UP_TO_TWO)
    assert [c.name for c in outcome.diagnosis.causes] == ["lvdt_drift"]


@pytest.mark.thorough
def test_zeros_that_differ_between_recordings_are_a_drift() -> None:
    outcome = diagnose(recordings([0.0, 0.004, 0.004, -0.003]), DesignModel(), (), UP_TO_TWO)
    assert [c.name for c in outcome.diagnosis.causes] == ["lvdt_drift"]


@pytest.mark.thorough
def test_a_drift_that_begins_anew_beside_a_zero_error_is_both() -> None:
    """Zeros of each recording's own would say it too, with more unknowns; either cause is needed for unseen rows."""
    found = recordings([0.004, 0.004, 0.004])
    drifting = [replace(r, position=r.position + 4e-5 * (r.time_s - r.time_s[0])) for r in found]
    outcome = diagnose(drifting, DesignModel(), (), UP_TO_TWO)
    causes = {c.name: c.heldout_gap_without for c in outcome.diagnosis.causes}
    assert set(causes) == {"lvdt_drift", "lvdt_calibration"}
    assert all(gap is not None and gap > 1.5 * outcome.diagnosis.gap.after for gap in causes.values())
