"""A loose core that a weight takes to one end of its play: its law, its beginning, and that it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.judged import UP_TO_TWO
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.diagnose import diagnose
from twin.kernels.sensor_slots import S_COUNT, S_PLAY, S_SINKS_S
from twin.kernels.sinking import core_of
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, reading_at, stem_at


def loose(form: str, *values: float) -> Inserted:
    return Inserted("linkage_lost_motion", effect("linkage_lost_motion").form(form), values)


@pytest.mark.parametrize(("side", "start"), [(1.0, 0.0), (-1.0, 0.01), (1.0, 5.0)])
def test_it_is_the_law_in_small_steps(side: float, start: float) -> None:
    t = np.linspace(0.0, 60.0, 6001)
    stem = 0.2 + 0.1 * np.interp(t, [0, 5, 8, 30, 31, 60], [0, 1, 1, -1, -1, -1])
    c = np.zeros(S_COUNT)
    c[S_PLAY], c[S_SINKS_S] = 0.03, side * 7.0
    found = core_of(t, stem, c, (stem[0] + start, stem[0] + start))[0]
    e, expected = min(stem[0] + 0.015, max(stem[0] - 0.015, stem[0] + start)), []
    for k in range(t.size):
        e = min(stem[k] + 0.015, max(stem[k] - 0.015, e))
        expected.append(e)
        e += 0.01 / 7.0 * (stem[k] + side * 0.015 - e)
    assert np.abs(found - expected).max() < 1e-4
    assert found[-1] == pytest.approx(stem[-1] + side * 0.015, abs=1e-3)


@pytest.mark.parametrize(("form", "shift"), [("sinks", 0.01), ("sinks_back", -0.01), ("play", 0.0)])
def test_a_core_has_sunk_before_the_record_begins(form: str, shift: float) -> None:
    values = (0.02,) if form == "play" else (0.02, 9.0)
    c = Plant(DESIGN, (loose(form, *values),)).coefficients(100.0)
    assert stem_at(c, 0.3) == pytest.approx(0.3 - shift)
    assert reading_at(c, stem_at(c, 0.3)) == pytest.approx(0.3)


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["sinks", "sinks_back"])
def test_slack_that_is_taken_up_is_a_lost_motion(form: str) -> None:
    trial, _ = trial_of(Plant(DESIGN, (loose(form, 0.03, 12.0),)), np.append(staircase(), staircase(7)))
    noise = np.random.default_rng(5).normal(0.0, 0.004, trial.recording.n)
    pressure = np.asarray(trial.recording.pressure) + noise
    said = diagnose([replace(trial.recording, pressure=pressure)], DESIGN, (), UP_TO_TWO).diagnosis
    assert [cause.name for cause in said.causes] == ["linkage_lost_motion"]
    assert said.gap.after is not None and said.gap.after < 1.1 * 100.0 * SIGMA / DESIGN.travel
