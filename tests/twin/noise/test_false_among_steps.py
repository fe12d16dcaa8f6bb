"""A display of few levels among false readings that are levels of their own."""

from __future__ import annotations

import numpy as np
import pytest

from twin.noise.lattice import lattice_step

STEP_IN, FINE_IN = 0.052, 0.00017


def swept(noise_in: float = 0.0007, rows: int = 9000) -> np.ndarray:
    """A stem that goes to and fro over its travel, in inches."""
    dice = np.random.default_rng(5)
    x = 0.28 - 0.28 * np.cos(np.linspace(0.0, 40.0 * np.pi, rows))
    return x + noise_in * dice.normal(size=rows)


def with_false(reading: np.ndarray, share: float) -> np.ndarray:
    dice = np.random.default_rng(6)
    rows = dice.random(reading.size) < share
    return np.where(rows, dice.uniform(0.0, 0.5625, reading.size), reading)


@pytest.mark.parametrize("share", [0.002, 0.01, 0.03])
def test_the_step_is_found_where_false_readings_are_more_levels_than_the_display_has(share: float) -> None:
    reading = with_false(STEP_IN * np.round(swept() / STEP_IN), share)
    assert lattice_step(reading) == pytest.approx(STEP_IN, rel=1e-3)
    counts = FINE_IN * np.round(reading / FINE_IN)  # ... and all of it is written by a converter with steps of its own
    assert lattice_step(counts) == pytest.approx(STEP_IN, rel=1e-2)


@pytest.mark.parametrize("share", [0.0, 0.01])
def test_a_fine_converter_keeps_its_step_among_false_readings(share: float) -> None:
    reading = FINE_IN * np.round(with_false(swept(), share) / FINE_IN)
    assert lattice_step(reading) == pytest.approx(FINE_IN, rel=1e-3)


def test_dwells_at_even_distances_with_the_way_between_them_are_no_steps() -> None:
    """Without noise and hardly ever under way: what is between two levels is one way, and no false reading."""
    stairs = np.repeat(np.arange(9.0), 300)
    dice = np.random.default_rng(7)
    for k in range(1, 9):
        stairs[300 * k : 300 * k + 5] = k - 1.0 + np.sort(dice.random(5))
    assert lattice_step(stairs) is None
