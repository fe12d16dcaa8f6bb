"""A soft linkage, half of whose pull is there before its play is taken up: its law, its state, and that it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from logs.recording import FloatArray, Recording
from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.diagnose import diagnose
from twin.fit.channel import predict_reading
from twin.fit.trial import make_trial
from twin.kernels.sinking import core_at_first, core_of, first_core
from twin.live.twin import LiveTwin
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import Start, simulate_recording

WIDTH, SOONER = 0.03, 0.4
T = np.linspace(0.0, 60.0, 601)
STEM = DESIGN.travel * (0.5 + 0.45 * np.sin(T / 7.0) + 0.05 * np.sin(T))


def linkage(form: str, *values: float) -> Plant:
    return Plant(DESIGN, (Inserted("linkage_lost_motion", effect("linkage_lost_motion").form(form), values),))


SHARE = 0.3
SOFT = linkage("soft", WIDTH, SOONER).coefficients(60.0).sensor
SLEEVE = linkage("sleeve", WIDTH, SHARE).coefficients(60.0).sensor


def test_half_of_it_goes_along_from_a_narrower_play() -> None:
    wide = narrow = STEM[0]
    expected = []
    for x in STEM:
        wide = min(x + 0.5 * WIDTH, max(x - 0.5 * WIDTH, wide))
        narrow = min(x + 0.5 * SOONER * WIDTH, max(x - 0.5 * SOONER * WIDTH, narrow))
        expected.append(0.5 * (wide + narrow))
    found, ends = core_of(T, STEM, SOFT, (STEM[0], STEM[0]))
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert ends == pytest.approx((wide, narrow), abs=1e-12)


def test_a_sleeve_passes_on_its_share_at_once() -> None:
    loose = STEM[0]
    expected = []
    for x in STEM:
        loose = min(x + 0.5 * WIDTH, max(x - 0.5 * WIDTH, loose))
        expected.append(SHARE * x + (1.0 - SHARE) * loose)
    found, _ = core_of(T, STEM, SLEEVE, (STEM[0], STEM[0]))
    np.testing.assert_allclose(found, expected, atol=1e-6 * WIDTH)


@pytest.mark.parametrize("c", [SOFT, SLEEVE], ids=["soft", "sleeve"])
def test_in_two_parts_it_is_the_same(c: FloatArray) -> None:
    whole, last = core_of(T, STEM, c, (0.3, 0.3))
    first, between = core_of(T[:300], STEM[:300], c, (0.3, 0.3))
    second, end = core_of(T[300:], STEM[300:], c, between)
    np.testing.assert_array_equal(np.append(first, second), whole)
    assert end == last


@given(st.floats(-0.02, 0.02))
def test_it_begins_where_it_is_read_as_far_as_it_can(off: float) -> None:
    wide, narrow = first_core(SOFT, 0.3, 0.3 + off)
    furthest = 0.25 * WIDTH * (1.0 + SOONER)
    assert 0.5 * (wide + narrow) == pytest.approx(0.3 + min(max(off, -furthest), furthest), abs=1e-12)
    assert abs(wide - 0.3) <= 0.5 * WIDTH + 1e-12 and abs(narrow - 0.3) <= 0.5 * SOONER * WIDTH + 1e-12


@given(st.floats(-0.02, 0.02))
def test_a_sleeve_begins_where_it_is_read_as_far_as_it_can(off: float) -> None:
    state = first_core(SLEEVE, 0.3, 0.3 + off)
    furthest = 0.5 * WIDTH * (1.0 - SHARE)
    assert core_at_first(SLEEVE, state) == pytest.approx(0.3 + min(max(off, -furthest), furthest), abs=1e-6)


@pytest.mark.parametrize(("form", "value", "reach"), [("soft", SOONER, 0.7), ("sleeve", SHARE, 0.7)])
@pytest.mark.parametrize(("way", "first_psi"), [(1.0, 9.4), (-1.0, 8.0)], ids=["closing", "opening"])
def test_a_stem_at_rest_stands_where_the_pressure_has_it_and_its_core_behind(
    form: str, value: float, reach: float, way: float, first_psi: float
) -> None:
    """The core was pulled up to here, or down, before the first row, and so stands off by all that the play allows."""
    plant, command = linkage(form, WIDTH, value), np.repeat([first_psi, 11.0, 6.0], 300)
    pressure = command[0]
    stem = DESIGN.compliance * (pressure - (DESIGN.a1 if way > 0 else DESIGN.a2))
    core = stem - way * reach * 0.5 * WIDTH
    blank = Recording("made", 0.1 * np.arange(command.size), command, np.zeros(command.size))
    psi, position = simulate_recording(plant, blank, start=Start(pressure, stem, stem, core))
    recording = replace(blank, pressure=psi, position=position)
    trial = make_trial(recording, 0.05)
    np.testing.assert_allclose(predict_reading(plant, trial), position, atol=0.01 * WIDTH)
    np.testing.assert_allclose(simulate_recording(plant, recording)[1], position, atol=0.01 * WIDTH)
    twin = LiveTwin.at_rest(plant, 0.0, command[0], float(position[0]), float(psi[0]), recording.duration_s)
    assert twin.step(1.0, command[0])[1] == pytest.approx(position[10], abs=0.01 * WIDTH)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("form", "width", "parameter", "value", "near"),
    [("soft", 0.04, "sooner", SOONER, 0.05), ("sleeve", 0.03, "share", SHARE, 0.03)],
)
def test_it_is_a_lost_motion_alone(form: str, width: float, parameter: str, value: float, near: float) -> None:
    trial, _ = trial_of(linkage(form, width, value), np.append(staircase(), staircase(7)))
    noise = np.random.default_rng(5).normal(0.0, 0.004, trial.recording.n)
    pressure = np.asarray(trial.recording.pressure) + noise
    said = diagnose([replace(trial.recording, pressure=pressure)], DESIGN, (), UP_TO_TWO).diagnosis
    assert [(cause.name, cause.form) for cause in said.causes] == [("linkage_lost_motion", form)]
    assert said.causes[0].parameters["play"].value == pytest.approx(width, abs=0.002)
    assert said.causes[0].parameters[parameter].value == pytest.approx(value, abs=near)
    assert said.gap.after is not None and said.gap.after < 1.1 * 100.0 * SIGMA / DESIGN.travel
