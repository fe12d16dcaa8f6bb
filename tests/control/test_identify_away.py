"""A loop about its set point, far from fully open: its deadband is identified, though both curves begin elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from control.identify import identify
from control.identify_result import Identified
from hal.errors import JobFailed
from logs.recording import FloatArray, Recording
from tests.control.toy_valve import Toy, respond

NOISE = 0.12
BEGIN = -3.0  # percent of command at which the opening curve would meet fully open


def loop(deadband: float, command: FloatArray, period_s: float = 10.0) -> Recording:
    """Rows every 10 s in percent, without a pressure, as a historian stores a flow loop."""
    toy = Toy(a1=BEGIN + deadband, a2=BEGIN, k1=2.7, k2=2.7, tau=6.0, rate=20.0, travel=100.0)
    time_s = period_s * np.arange(command.size)
    _, position = respond(toy, time_s, command, step_s=0.1)
    noise = np.random.default_rng(7).normal(0.0, NOISE, time_s.size)
    return Recording("loop", time_s, command, position + noise, pressure_unit="percent", position_unit="percent")


def wandering(rows: int = 550) -> FloatArray:
    """A controller's output: slow, to and fro over some 5 %."""
    rows_s = 10.0 * np.arange(rows)
    return 24.0 + 1.6 * np.sin(rows_s / 190.0) + 0.9 * np.sin(rows_s / 61.0 + 1.0)


@pytest.fixture(scope="module")
def sticks() -> Identified:
    return identify([loop(2.0, wandering())])


@pytest.mark.thorough
def test_the_deadband_and_the_slope_of_a_valve_that_sticks(sticks: Identified) -> None:
    for name, truth in (("deadband", 2.0), ("compliance", 2.7)):
        interval = sticks[name].interval
        assert interval is not None
        assert interval.holds(truth)
        assert interval.half_width < 0.05 * truth
    assert sticks.quality.rms < 1.15 * NOISE


@pytest.mark.thorough
def test_the_two_curves_are_said_to_hold_together_only(sticks: Identified) -> None:
    assert any("hold together only" in note for note in sticks.notes)
    assert not any("positioner" in note for note in sticks.notes)  # a curve that begins below no pressure is no sign
    assert sticks.design.a1 - sticks.design.a2 == pytest.approx(2.0, abs=0.1)


@pytest.mark.thorough
def test_a_loop_without_play_has_none() -> None:
    found = identify([loop(0.0, wandering())])
    assert found["deadband"].value < 0.1
    assert found["compliance"].value == pytest.approx(2.7, rel=0.02)


def test_one_stroke_away_from_fully_open_says_nothing() -> None:
    with pytest.raises(JobFailed, match="sweep through both"):
        identify([loop(2.0, np.linspace(21.0, 26.0, 300))])
