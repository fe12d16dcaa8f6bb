"""Numbers that were identified from the very records take in what only says that they were not found well enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from twin.ready.identified import better_identified
from twin.replay.simulate import simulate_recording

DESIGN = DesignModel()
TIME_S = np.arange(0.0, 120.0, 0.1)
COMMAND = 8.0 + 7.0 * np.sin(2.0 * np.pi * TIME_S / 60.0 - 1.5)
SWEPT = Recording("swept", TIME_S, COMMAND, np.zeros(TIME_S.size))


def reading(model: DesignModel) -> FloatArray:
    return simulate_recording(model, SWEPT)[1]


@settings(max_examples=20, deadline=None)
@given(missing=st.floats(0.01, 0.4), gain=st.floats(-0.3, 0.3))
def test_a_stop_and_a_gain_become_numbers_that_read_the_same(missing: float, gain: float) -> None:
    effects = {
        "reduced_travel": {"form": "upper_stop", "missing": missing},
        "lvdt_calibration": {"form": "gain", "gain": gain},
    }
    model = replace(DESIGN, effects=effects)
    better = better_identified(effects, model)
    assert better is not None and not better.effects
    assert better.travel == pytest.approx((1.0 + gain) * (1.0 - missing) * DESIGN.travel)
    assert np.allclose(reading(better), reading(model), atol=2e-4 * DESIGN.travel)


def test_wrong_numbers_are_taken_as_they_were_found() -> None:
    model = replace(DESIGN, tau_s=3.3, effects={"creep": {"form": "tail", "share": 0.1, "tau": 20.0}})
    assert better_identified(["creep", "parameter:tau"], model) == replace(model, effects={})


@pytest.mark.parametrize("form", ["lower_stop", "upper_seat"])
def test_what_is_no_number_of_a_design_stays_a_cause(form: str) -> None:
    """A zero and a stop at the open end are of no number, and a seat that gives way is none."""
    effects = {"reduced_travel": {"form": form, "missing": 0.1}, "lvdt_calibration": {"form": "zero", "zero": 0.01}}
    assert better_identified(effects, replace(DESIGN, effects=effects)) is None
    assert better_identified((), DESIGN) is None


def test_of_two_stops_the_closed_one_is_a_number() -> None:
    stops: dict[str, float | str] = {"form": "both_stops", "missing_open": 0.0, "missing_closed": 0.08}
    model = replace(DESIGN, effects={"reduced_travel": stops})
    better = better_identified(["reduced_travel"], model)
    assert better is not None and better.travel == pytest.approx(0.92 * DESIGN.travel)
    assert np.allclose(reading(better), reading(model), atol=2e-4 * DESIGN.travel)
