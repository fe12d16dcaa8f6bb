"""Where no pressure was measured, the play between converter and valve tells their lags apart."""

from __future__ import annotations

import numpy as np
import pytest

from bench.identify_strangers import drawn
from control.identify import identify
from logs.recording import FloatArray, Recording
from tests.control.toy_valve import Toy, random_steps, respond

NOISE = 0.05


def recorded(toy: Toy, command: FloatArray, period_s: float) -> Recording:
    """In percent, as a stranger's file is."""
    time_s = period_s * np.arange(command.size)
    _, position = respond(toy, time_s, command, step_s=0.02)
    noise = np.random.default_rng(3).normal(0.0, NOISE, time_s.size)
    return Recording("stranger", time_s, command, position + noise, pressure_unit="percent", position_unit="percent")


def valve(deadband: float, tau_s: float, ep_tau_s: float) -> Toy:
    return Toy(ep_tau=ep_tau_s, a1=8.0 + deadband, a2=8.0, k1=1.4, k2=1.4, tau=tau_s, rate=1e6, travel=100.0)


@pytest.mark.parametrize(("tau_s", "ep_tau_s"), [(4.0, 1.5), (0.9, 0.05), (2.0, 0.3)])
def test_the_converters_lag_is_fitted_and_bends_no_other_number(tau_s: float, ep_tau_s: float) -> None:
    command = random_steps(200.0, 0.2, low=5.0, high=90.0, seed=4)
    found = identify([recorded(valve(20.0, tau_s, ep_tau_s), command, 0.2)])
    assert found["deadband"].value == pytest.approx(20.0, rel=0.01)
    assert found["tau"].value == pytest.approx(tau_s, rel=0.03)
    assert found["ep.tau"].value == pytest.approx(ep_tau_s, rel=0.1)
    assert found.quality.rms == pytest.approx(NOISE, rel=0.1)


def test_a_play_is_found_that_is_a_tenth_of_what_the_commands_go_through() -> None:
    # A fit that starts without one ends in a minimum without one, 0.3 % off.
    time_s = 0.05 * np.arange(5000)
    ramp = 20.0 + 38.0 * np.abs((time_s / 46.0) % 2.0 - 1.0)
    ramp += np.where((time_s / 46.0) % 2.0 > 1.0, 2.5, -2.5)
    found = identify([recorded(valve(5.0, 1.15, 0.16), ramp, 0.05)])
    assert found["deadband"].value == pytest.approx(5.0, rel=0.02)
    assert found.quality.rms == pytest.approx(NOISE, rel=0.1)


def test_a_lag_that_nothing_shows_is_kept_and_said() -> None:
    # Rows and steps so slow that neither lag leaves a trace.
    command = np.repeat(random_steps(150.0, 5.0, low=5.0, high=90.0, seed=4), 4)
    found = identify([recorded(valve(20.0, 0.02, 0.02), command, 5.0)])
    assert found["ep.tau"].interval is None
    assert found["deadband"].value == pytest.approx(20.0, rel=0.01)


@pytest.mark.thorough
def test_a_wide_play_behind_sines_is_found() -> None:
    """From starts with no play or one of half the range alone the fit ends without one, 6 times the noise off."""
    recording, stranger, _, noise = drawn(9)
    found = identify([recording])
    assert found["deadband"].value == pytest.approx(stranger.deadband, rel=0.01)
    assert found["ep.tau"].value == pytest.approx(stranger.ep_tau_s, rel=0.1)
    assert found.quality.rms == pytest.approx(noise, rel=0.1)
