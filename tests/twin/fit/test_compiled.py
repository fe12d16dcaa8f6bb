"""Residuals and slopes of whole columns, compiled: the same as NumPy has them, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.fit.compiled import at_all_rows, in_noise

SEEDS = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize("half", [0.0, 0.3])
@given(seed=SEEDS)
def test_residuals_are_errors_in_noise_where_rows_count(half: float, seed: int) -> None:
    chance = np.random.default_rng(seed)
    measured, predicted = chance.standard_normal((2, 40))
    predicted[:2] = np.nan, np.inf
    use = chance.random(40) < 0.8
    error = measured - predicted
    if half:
        error -= np.clip(error, -half, half)
    np.testing.assert_array_equal(in_noise(measured, predicted, use, 0.7, half), np.where(use, error / 0.7, 0.0))


@given(seed=SEEDS, columns=st.integers(1, 4), others=st.integers(0, 3))
def test_between_rows_columns_go_straight(seed: int, columns: int, others: int) -> None:
    chance = np.random.default_rng(seed)
    rows = np.unique([0, 59, *chance.integers(0, 60, 12)]).astype(np.int64)
    few = np.asfortranarray(chance.standard_normal((rows.size + others, columns)))
    use = chance.random(60) < 0.8
    every = at_all_rows(few, rows, use)
    straight = [np.where(use, np.interp(np.arange(60), rows, column), 0.0) for column in few[: rows.size].T]
    np.testing.assert_array_equal(every[:60].T, straight)
    np.testing.assert_array_equal(every[60:], few[rows.size :])
