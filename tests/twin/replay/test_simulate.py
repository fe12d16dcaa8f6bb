"""Replay of a recording: where it starts, gaps, units, no pressure, effects of the file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from hal.errors import BadInput
from logs.recording import FloatArray, Recording
from twin.model.model_units import in_units_of
from twin.replay.simulate import simulate_recording, step_for

DESIGN = DesignModel()
TIME_S = np.arange(1200) * 0.1
COMMAND = np.repeat(np.random.default_rng(5).uniform(5.0, 13.0, 24), 50)


def truth(design: DesignModel = DESIGN) -> Recording:
    """What the model itself reads, from open, long before the first row that is kept."""
    blank = Recording("truth", TIME_S, COMMAND, np.zeros(TIME_S.size))
    p, y = simulate_recording(design, blank)
    return replace(blank, pressure=p, position=y)


def worst(a: FloatArray, b: FloatArray) -> float:
    return float(np.abs(a - b).max())


def test_a_model_reproduces_its_own_record() -> None:
    record = truth()
    assert record.pressure is not None
    p, y = simulate_recording(DESIGN, record)
    assert worst(p, record.pressure) < 1e-9
    assert worst(y, record.position) < 1e-9


def test_a_record_that_begins_in_motion() -> None:
    """Cut 1 s after a step: pressure has moved on, the stem is on its way to a target nobody measured."""
    record = truth().slice(60, 1200)
    p, y = simulate_recording(DESIGN, record)
    assert record.pressure is not None
    assert worst(p[5:], record.pressure[5:]) < 0.05
    assert worst(y, record.position) < 0.02 * DESIGN.travel


def test_without_pressure_it_starts_at_the_first_command() -> None:
    record = replace(truth(), pressure=None)
    p, _ = simulate_recording(DESIGN, record)
    assert p[0] == COMMAND[0]


def test_effects_of_the_file_act() -> None:
    lagging = replace(DESIGN, effects={"sensor_lag": {"lag": 1.0}})
    record = truth()
    _, y = simulate_recording(lagging, record)
    assert worst(y, record.position) > 0.05 * DESIGN.travel


def test_a_false_first_reading_does_not_decide_the_start() -> None:
    record = truth()
    position = record.position.copy()
    position[0], position[3] = 0.5, np.nan
    _, y = simulate_recording(DESIGN, replace(record, position=position))
    assert worst(y[20:], record.position[20:]) < 0.01 * DESIGN.travel


def test_the_start_is_a_stem_position_not_a_reading() -> None:
    off = replace(DESIGN, effects={"lvdt_calibration": {"form": "zero", "zero": 0.05}})
    record = truth(off)
    _, y = simulate_recording(off, record)
    assert worst(y, record.position) < 1e-6


def test_a_gap_is_simulated_through() -> None:
    record = truth()
    keep = np.r_[0:400, 420:1200]  # the 2 s within one level
    gappy = Recording(
        "gappy", TIME_S[keep], COMMAND[keep], record.position[keep], gap_before=np.diff(keep, prepend=-1) > 1
    )
    _, y = simulate_recording(DESIGN, gappy)
    assert worst(y, record.position[keep]) < 1e-3 * DESIGN.travel


def test_other_units_give_the_same_reading() -> None:
    with_effect = replace(DESIGN, effects={"stiction": {"form": "one_jump", "breakaway": 0.3}})
    metric = in_units_of(with_effect, "kPa", "mm")
    record = truth(with_effect)
    scale_p, scale_x = 6.894757293168361, 25.4
    other = replace(
        record, command=COMMAND * scale_p, pressure=None, position=record.position * scale_x,
        pressure_unit="kPa", position_unit="mm",
    )  # fmt: skip
    _, y = simulate_recording(metric, other)
    assert worst(y / scale_x, record.position) < 1e-6


def test_percent_and_psi_do_not_mix() -> None:
    with pytest.raises(BadInput, match="percent"):
        in_units_of(DESIGN, "percent", "percent")


def test_percent_stays_percent() -> None:
    bench = DesignModel(0.3, 60.0, 40.0, 2.0, 2.0, 20.0, 100.0, "percent", "percent")
    assert in_units_of(bench, "percent", "percent") == bench


def test_too_short() -> None:
    with pytest.raises(BadInput, match="1 rows"):
        simulate_recording(DESIGN, truth().slice(0, 1))


def test_step_is_short_against_the_lags() -> None:
    assert step_for(DESIGN) == pytest.approx(0.02)
    assert step_for(replace(DESIGN, ep_tau_s=0.03)) < 0.01
    assert step_for(replace(DESIGN, ep_tau_s=0.0, tau_s=0.0)) == pytest.approx(0.002)
