"""A stem that follows its command's jitter goes nowhere within a window, and is no noise for it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from logs.recording import FloatArray, Recording
from twin.noise.model import estimate_noise

ROWS, SIGMA = 4000, 0.2


def restless(seed: int = 1) -> FloatArray:
    """A command [%] that goes up and down in every row, as of a loop about a noisy flow."""
    return 60.0 + 5.0 * np.random.default_rng(seed).standard_normal(ROWS)


def record(command: FloatArray, position: FloatArray, period_s: float = 1.0) -> Recording:
    return Recording("loop", period_s * np.arange(ROWS), command, position)


def noise(seed: int = 2) -> FloatArray:
    return SIGMA * np.random.default_rng(seed).standard_normal(ROWS)


@pytest.mark.parametrize("lag_rows", [0.3, 2.0, 8.0])
def test_what_follows_the_command_is_no_noise(lag_rows: float) -> None:
    command = restless()
    pole = float(np.exp(-1.0 / lag_rows))
    stem = 60.0 + lfilter([0.0, 1.0 - pole], [1.0, -pole], command - 60.0)
    found = estimate_noise([record(command, stem + noise())]).position
    assert found.source == "still"
    assert SIGMA <= found.sigma < 0.45 * float(np.std(stem))


def test_a_stem_at_rest_under_a_restless_command_keeps_its_noise() -> None:
    found = estimate_noise([record(restless(), 60.0 + noise())]).position
    assert found.sigma == pytest.approx(SIGMA, rel=0.05)


def test_noise_that_a_controller_answers_stays_noise() -> None:
    """Slow noise of the gauge is in the commands before the reading, the other way round."""
    slow = lfilter([np.sqrt(1.0 - 0.9**2)], [1.0, -0.9], noise())
    found = estimate_noise([record(60.0 - 3.0 * slow, 60.0 + slow, 0.1)]).position
    alone = estimate_noise([record(restless(), 60.0 + slow, 0.1)]).position
    assert found.sigma == pytest.approx(alone.sigma, rel=0.05)


def test_missing_readings_have_no_say() -> None:
    command = restless()
    position = 60.0 + np.concatenate([[0.0], 0.8 * (command[:-1] - 60.0)]) + noise()
    position[np.random.default_rng(3).random(ROWS) < 0.1] = np.nan
    assert estimate_noise([record(command, position)]).position.sigma < 0.5  # of 4.0 that the stem goes
