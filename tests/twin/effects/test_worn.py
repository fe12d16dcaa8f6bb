"""A linkage that is worn where the stem is most: its law, its beginning, and that it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.diagnose import diagnose
from twin.kernels.sinking import core_of, first_core
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant

TRAVEL = DESIGN.travel
WIDTHS = (0.01, 0.01, 0.03, 0.04)


def linkage(form: str, values: tuple[float, ...]) -> Plant:
    return Plant(DESIGN, (Inserted("linkage_lost_motion", effect("linkage_lost_motion").form(form), values),))


def test_it_goes_along_from_the_ends_of_a_play_that_goes_by_where_the_stem_is() -> None:
    t = np.linspace(0.0, 60.0, 601)
    stem = TRAVEL * (0.5 + 0.45 * np.sin(t / 7.0) + 0.05 * np.sin(t))
    c = linkage("worn", WIDTHS).coefficients(60.0).sensor
    e, expected = stem[0], []
    for x in stem:
        half = 0.5 * np.interp(x, np.linspace(0.0, TRAVEL, 4), WIDTHS)
        e = min(x + half, max(x - half, e))
        expected.append(e)
    np.testing.assert_allclose(core_of(t, stem, c, (stem[0], stem[0]))[0], expected, atol=1e-12)


def test_alike_everywhere_it_is_plain_play() -> None:
    t = np.linspace(0.0, 60.0, 601)
    stem = TRAVEL * (0.5 + 0.5 * np.sin(t / 7.0))
    worn, plain = (linkage(*one).coefficients(60.0).sensor for one in (("worn", (0.02,) * 4), ("play", (0.02,))))
    np.testing.assert_allclose(*(core_of(t, stem, c, (0.3, 0.3))[0] for c in (worn, plain)), atol=1e-15)


@pytest.mark.parametrize(("stem", "half"), [(0.0, 0.005), (TRAVEL, 0.02), (0.5 * TRAVEL, 0.01), (2.0 * TRAVEL, 0.02)])
def test_a_core_that_is_said_to_stand_off_is_within_the_play_there(stem: float, half: float) -> None:
    c = linkage("worn", WIDTHS).coefficients(60.0).sensor
    assert first_core(c, stem, 9.0)[0] == pytest.approx(stem + half)
    assert first_core(c, stem, -9.0)[0] == pytest.approx(stem - half)
    assert first_core(c, stem, np.nan) == (stem, stem)


@pytest.mark.thorough
def test_a_linkage_worn_at_one_end_is_a_lost_motion() -> None:
    trial, _ = trial_of(linkage("worn", (0.008, 0.008, 0.03, 0.03)), np.append(staircase(), staircase(7)))
    noise = np.random.default_rng(5).normal(0.0, 0.004, trial.recording.n)
    pressure = np.asarray(trial.recording.pressure) + noise
    said = diagnose([replace(trial.recording, pressure=pressure)], DESIGN, (), UP_TO_TWO).diagnosis
    assert [(cause.name, cause.form) for cause in said.causes] == [("linkage_lost_motion", "worn")]
    assert said.causes[0].parameters["open"].value == pytest.approx(0.008, abs=0.002)
    assert said.causes[0].parameters["closed"].value == pytest.approx(0.03, abs=0.002)
    assert said.gap.after is not None and said.gap.after < 1.1 * 100.0 * SIGMA / DESIGN.travel
