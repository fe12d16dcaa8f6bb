"""Friction along the stroke: the free profile follows what comes and goes a few times, wherever it begins."""

from __future__ import annotations

import numpy as np
import pytest

from twin.effects.position_dependent_friction import KNOTS


@pytest.mark.parametrize("waves", [1, 2, 3])
@pytest.mark.parametrize("phase", [0.0, 0.8, 1.6, 2.4])
def test_a_wave_along_the_stroke_is_followed(waves: int, phase: float) -> None:
    """The best straight pieces between the knots leave less than a sixth of it."""
    at = np.linspace(0.0, 1.0, 600)
    wave = np.sin(2.0 * np.pi * waves * at + phase)
    tents = np.array([np.interp(at, KNOTS, row) for row in np.eye(len(KNOTS))]).T
    values, *_ = np.linalg.lstsq(tents, wave, rcond=None)
    assert np.std(wave - tents @ values) < np.std(wave) / 6.0
