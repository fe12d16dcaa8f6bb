"""Describing functions against sampled sines and against python-control.

The reference numbers come from python-control 0.10.2 in an environment of its own:
`control.describing_function(control.friction_backlash_nonlinearity(2.96), A)`.
"""

from __future__ import annotations

import numpy as np
import pytest

from control.analysis.describing import (
    first_harmonic,
    play,
    play_describing_function,
    play_numerically,
    saturation_describing_function,
)

PYTHON_CONTROL = [
    (1.6, 0.03407372001634673 - 0.08833099341600201j),
    (2.0, 0.2065999038478144 - 0.24497128840704532j),
    (3.0, 0.5084880121207529 - 0.3182532977595802j),
    (5.0, 0.7523430237755301 - 0.26532274929009214j),
    (10.0, 0.9077533368096877 - 0.16055041363292505j),
    (40.0, 0.9880526623900232 - 0.04536679821845858j),
]


@pytest.mark.parametrize(("amplitude", "reference"), PYTHON_CONTROL)
def test_the_play_agrees_with_python_control(amplitude: float, reference: complex) -> None:
    n = complex(play_describing_function(np.array([amplitude]), 2.96, 1.0)[0])
    assert abs(n - reference) < 2e-3


@pytest.mark.parametrize("amplitude", [1.5, 2.2, 6.0, 30.0])
def test_the_closed_form_is_the_first_harmonic(amplitude: float) -> None:
    closed = complex(play_describing_function(np.array([amplitude]), 2.96, 0.19)[0])
    assert abs(closed - play_numerically(amplitude, 2.96, 0.19)) < 1e-5


def test_inside_the_gap_nothing_comes_through() -> None:
    assert complex(play_describing_function(np.array([1.0]), 2.96, 0.19)[0]) == 0.0
    assert play_numerically(1.0, 2.96, 0.19) == pytest.approx(0.0, abs=1e-12)


def test_the_play_lags() -> None:
    angle = 2.0 * np.pi * np.arange(1000) / 1000
    wave = play(3.0 * np.cos(angle), 2.0, 1.0)
    assert wave.max() == pytest.approx(2.0)
    assert np.angle(first_harmonic(wave)) < -0.3


def test_saturation_against_a_sampled_sine() -> None:
    angle = 2.0 * np.pi * np.arange(4096) / 4096
    sampled = first_harmonic(np.clip(3.0 * np.cos(angle), -1.0, 1.0)) / 3.0
    assert saturation_describing_function(np.array([3.0]), 1.0)[0] == pytest.approx(sampled.real, abs=1e-5)
    assert saturation_describing_function(np.array([0.5]), 1.0)[0] == pytest.approx(1.0)
