"""The linear part of the loop against scipy.signal: continuous, and sampled with a hold and a tick of delay."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from control.analysis.loop import LinearLoop, thesis_loop
from control.design import DesignModel
from control.tune import phase_margin

DESIGN = DesignModel()
CHAIN = ([1.0], np.polymul([0.30, 1.0], [2.7, 1.0]))


def test_the_thesis_curve_is_that_of_scipy() -> None:
    omega = np.geomspace(0.01, 30.0, 50)
    _, reference = signal.freqs([1.0], [2.7, 1.0], omega)
    assert np.abs(thesis_loop()(omega) - reference).max() < 1e-12


@pytest.mark.parametrize(("law", "kp", "ki"), [("p", 3.0, 0.0), ("pi", 3.0, 8.0), ("pi", 26.3, 9.75)])
def test_a_continuous_loop_is_that_of_scipy(law: str, kp: float, ki: float) -> None:
    omega = np.geomspace(0.01, 30.0, 50)
    numerator, denominator = ([kp, ki], np.polymul(CHAIN[1], [1.0, 0.0])) if ki else ([kp], CHAIN[1])
    _, reference = signal.freqs(numerator, denominator, omega)
    found = LinearLoop(law, kp, ki, tick_s=0.0)(omega)  # type: ignore[arg-type]
    assert np.abs(found / reference - 1.0).max() < 1e-12


@pytest.mark.parametrize(("law", "kp", "ki"), [("p", 3.0, 0.0), ("pi", 3.0, 8.0)])
def test_a_sampled_loop_is_that_of_scipy_up_to_a_tenth_of_the_sampling_rate(law: str, kp: float, ki: float) -> None:
    """scipy samples the chain with a hold exactly; what is left are the images, which the loop here leaves out."""
    tick_s = 0.1
    omega = np.geomspace(0.01, 0.1 * 2.0 * np.pi / tick_s, 40)
    numerator, denominator, _ = signal.cont2discrete(CHAIN, tick_s, method="zoh")
    _, reference = signal.freqz(numerator.ravel(), denominator, omega * tick_s)
    z = np.exp(1j * omega * tick_s)
    reference = reference / z * (kp + (ki * tick_s / (z - 1.0) if ki else 0.0))
    found = LinearLoop(law, kp, ki, tick_s=tick_s)(omega)  # type: ignore[arg-type]
    assert np.abs(found / reference - 1.0).max() < 0.03


def test_the_phase_margin_is_that_of_scipys_curve() -> None:
    omega = np.geomspace(0.1, 10.0, 20000)
    _, gain_db, phase_deg = signal.bode((0.19 * np.array([26.3, 9.75]), np.polymul(CHAIN[1], [1.0, 0.0])), omega)
    crossing = int(np.flatnonzero(gain_db < 0.0)[0])
    assert phase_margin(LinearLoop("pi", 26.3, 9.75, tick_s=0.0), DESIGN) == pytest.approx(
        180.0 + phase_deg[crossing], abs=0.1
    )


@pytest.mark.parametrize("law", ["p", "p_incremental", "pi"])
def test_a_late_reading_turns_the_whole_loop_and_dead_time_not_that_of_an_accumulator(law: str) -> None:
    omega = np.geomspace(0.01, 3.0, 20)
    plain, late, dead = (
        LinearLoop(law, 3.0, 1.0, **delay)(omega)  # type: ignore[arg-type]
        for delay in ({}, {"late_s": 0.4}, {"dead_time_s": 0.4})
    )
    turned = plain * np.exp(-0.4j * omega)
    assert np.abs(late / turned - 1.0).max() < 1e-12
    if law == "p_incremental":
        assert (np.abs(dead) < np.abs(plain)).all()  # it adds up more slowly
    else:
        assert np.abs(dead / turned - 1.0).max() < 1e-12


def test_the_grid_ends_where_sampling_does() -> None:
    assert LinearLoop("p", 3.0, tick_s=0.2).frequencies(7)[[0, -1]] == pytest.approx([1e-3, np.pi / 0.2])
    assert LinearLoop("p", 3.0, tick_s=0.0).frequencies(7)[[0, -1]] == pytest.approx([1e-3, 1e3])
