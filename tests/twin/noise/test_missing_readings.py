"""Readings that are missing say nothing of the noise: of what is there it is as loud as before, and has no steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import UP_TO_TWO, a_record
from tests.twin.toy_valve import Toy, record, staircase
from twin.diagnose import diagnose
from twin.model.plant import Plant
from twin.noise.blurred import blurred_step
from twin.noise.fast import fast_memory, fast_sigma
from twin.noise.model import estimate_noise
from twin.noise.robust import autocorrelation, correlation_samples
from twin.noise.still import even_windows, given_back, still_pieces

SIGMA_IN, DT_S, ROWS = 6e-4, 0.1, 6000
#: Which rows have no reading: as of a position polled more rarely than the command is told, or of replies lost.
PATTERNS = ["every 2nd", "every 3rd", "every 4th", "all but every 2nd", 0.1, 0.2, 0.3, 0.4, 0.5]


def missing(pattern: str | float, rows: int = ROWS) -> npt.NDArray[np.bool_]:
    if isinstance(pattern, float):
        return np.random.default_rng(0).random(rows) < pattern
    first = int(pattern.startswith("all but"))
    return np.asarray(np.arange(rows) % int(pattern[-3]) == first)


def lacking(signal: FloatArray, pattern: str | float) -> FloatArray:
    return np.where(missing(pattern, signal.size), np.nan, signal)


def remembering(memory: float, seed: int, rows: int = ROWS) -> FloatArray:
    noise = np.random.default_rng(seed).standard_normal(rows)
    for i in range(1, rows):
        noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * noise[i]
    return noise


def healthy() -> Recording:
    levels = list(np.random.default_rng(1).uniform(3.0, 15.0, 50))
    return record(Toy(), staircase(DT_S, ROWS * DT_S / 50, levels), DT_S, 2, SIGMA_IN)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_the_noise_is_that_of_the_readings_and_no_display_is_made_of_them(pattern: str | float) -> None:
    whole = healthy()
    some = replace(whole, position=lacking(whole.position, pattern))
    noise = estimate_noise([some]).position
    assert noise.source == "still"
    assert noise.sigma == pytest.approx(SIGMA_IN, rel=0.1)
    assert noise.correlation_samples < 1.6 and len(noise.ar) <= 1
    assert blurred_step([some], noise.sigma) == (0.0, 0.0)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_fast_changes_alone_say_the_same(pattern: str | float) -> None:
    """With motion that would drown the noise if it were taken for a change from row to row."""
    motion = 0.2 * np.sin(2.0 * np.pi * np.arange(ROWS) * DT_S / 200.3)
    for memory in (0.0, 0.6):
        signal = lacking(motion + SIGMA_IN * remembering(memory, 4), pattern)
        assert fast_memory(signal)[0] == pytest.approx(SIGMA_IN, rel=0.2)
        assert fast_memory(signal)[1] == pytest.approx(memory, abs=0.35)


@pytest.mark.parametrize("pattern", ["every 2nd", "every 3rd", 0.1, 0.3])
def test_a_memory_is_that_from_row_to_row(pattern: str | float) -> None:
    signal = lacking(remembering(0.7, 8, 20_000), pattern)
    pieces = still_pieces(signal, DT_S, even_windows(signal.size, DT_S))
    rho, _grown = given_back(autocorrelation(pieces), [piece.size for piece in pieces])
    assert correlation_samples(rho) == pytest.approx((1 + 0.7) / (1 - 0.7), rel=0.35)


def test_holes_and_rests_of_a_file_full_of_them() -> None:
    whole = healthy()
    holes = np.zeros(ROWS, dtype=bool)
    for start in range(0, ROWS, 60):
        holes[start : start + 20] = True
    signal = np.where(holes, np.nan, whole.position)
    assert estimate_noise([replace(whole, position=signal)]).position.sigma == pytest.approx(SIGMA_IN, rel=0.1)
    assert fast_sigma(np.full(50, np.nan)) == fast_sigma(np.array([np.nan, 1.0, np.nan, 2.0])) == 0.0
    assert fast_memory(np.full(50, np.nan)) == (0.0, 0.0)
    assert estimate_noise([replace(whole, position=np.full(ROWS, np.nan))]).position.sigma == 0.0


def test_a_record_at_rest_whose_reading_never_changes_says_nothing_of_the_noise() -> None:
    whole = healthy()
    rests = Recording("rest", whole.time_s, np.full(ROWS, 15.0), np.full(ROWS, 0.5625), np.full(ROWS, 15.0))
    both = estimate_noise([whole, rests]).position
    assert both.sigma == estimate_noise([whole]).position.sigma
    assert estimate_noise([rests]).position.sigma == 0.0


@pytest.mark.thorough
@pytest.mark.parametrize("pattern", ["every 2nd", 0.3])
def test_a_healthy_valve_has_no_gap(pattern: str | float) -> None:
    whole = a_record(Plant(DesignModel()))
    some = replace(whole, position=lacking(whole.position, pattern))
    found = diagnose([some], DesignModel(), (), UP_TO_TWO)
    assert found.diagnosis.verdict == "no_gap"
    assert not found.diagnosis.causes
