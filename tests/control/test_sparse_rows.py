"""Motion that looks like noise is known by what moves it."""

from __future__ import annotations

import numpy as np
import pytest

from control.sparse_rows import refuse_sparse_motion
from hal.errors import BadInput
from logs.recording import Recording

ROWS = 60
CHANCE = np.random.default_rng(4)
COMMAND = CHANCE.uniform(4.0, 12.0, ROWS)


def record(position: np.ndarray) -> Recording:
    return Recording("r", 12.0 * np.arange(ROWS), COMMAND, position)


def test_a_reading_that_goes_with_the_command_is_no_noise() -> None:
    moved = 0.05 * COMMAND + CHANCE.normal(0.0, 0.02, ROWS)
    moved[7] = np.nan
    with pytest.raises(BadInput, match=r"^r: the position goes with the command.*12 s"):
        refuse_sparse_motion(record(moved), COMMAND)


@pytest.mark.parametrize("position", [CHANCE.normal(0.3, 0.02, ROWS), np.full(ROWS, 0.3), np.full(ROWS, np.nan)])
def test_a_stem_that_rests_is_left_to_others(position: np.ndarray) -> None:
    refuse_sparse_motion(record(position), COMMAND)
