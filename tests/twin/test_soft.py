"""A soft linkage, half of whose pull is there before its play is taken up: its law, its state, and that it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.catalog import effect
from twin.diagnose import diagnose
from twin.kernels.sinking import core_of, first_core
from twin.plant import Inserted, Plant

WIDTH, SOONER = 0.03, 0.4
T = np.linspace(0.0, 60.0, 601)
STEM = DESIGN.travel * (0.5 + 0.45 * np.sin(T / 7.0) + 0.05 * np.sin(T))


def linkage(form: str, *values: float) -> Plant:
    return Plant(DESIGN, (Inserted("linkage_lost_motion", effect("linkage_lost_motion").form(form), values),))


SOFT = linkage("soft", WIDTH, SOONER).coefficients(60.0).sensor


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


def test_in_two_parts_it_is_the_same() -> None:
    whole, last = core_of(T, STEM, SOFT, (0.3, 0.3))
    first, between = core_of(T[:300], STEM[:300], SOFT, (0.3, 0.3))
    second, end = core_of(T[300:], STEM[300:], SOFT, between)
    np.testing.assert_array_equal(np.append(first, second), whole)
    assert end == last


@given(st.floats(-0.02, 0.02))
def test_it_begins_where_it_is_read_as_far_as_it_can(off: float) -> None:
    wide, narrow = first_core(SOFT, 0.3, 0.3 + off)
    furthest = 0.25 * WIDTH * (1.0 + SOONER)
    assert 0.5 * (wide + narrow) == pytest.approx(0.3 + min(max(off, -furthest), furthest), abs=1e-12)
    assert abs(wide - 0.3) <= 0.5 * WIDTH + 1e-12 and abs(narrow - 0.3) <= 0.5 * SOONER * WIDTH + 1e-12


@pytest.mark.thorough
def test_a_soft_linkage_is_a_lost_motion_alone() -> None:
    trial, _ = trial_of(linkage("soft", 0.04, SOONER), np.append(staircase(), staircase(7)))
    noise = np.random.default_rng(5).normal(0.0, 0.004, trial.recording.n)
    pressure = np.asarray(trial.recording.pressure) + noise
    said = diagnose([replace(trial.recording, pressure=pressure)], DESIGN, (), UP_TO_TWO).diagnosis
    assert [(cause.name, cause.form) for cause in said.causes] == [("linkage_lost_motion", "soft")]
    assert said.causes[0].parameters["play"].value == pytest.approx(0.04, abs=0.002)
    assert said.causes[0].parameters["sooner"].value == pytest.approx(SOONER, abs=0.05)
    assert said.gap.after is not None and said.gap.after < 1.1 * 100.0 * SIGMA / DESIGN.travel
