"""The fit in percent that pictures and figures show."""

from __future__ import annotations

import numpy as np
import pytest

from app.fit_picture import fit_percent


def test_the_fit_is_what_is_left_over_what_varies() -> None:
    """A model that makes nine tenths of every movement fits by 90 %, a constant one by nothing, a mirrored one less."""
    measured = np.sin(np.arange(50.0))
    middle = measured.mean()
    assert fit_percent(measured, middle + 0.9 * (measured - middle)) == pytest.approx(90.0)
    assert fit_percent(measured, np.full(50, middle)) == pytest.approx(0.0)
    assert fit_percent(measured, 2.0 * middle - measured) == pytest.approx(-100.0)


def test_rows_that_were_not_read_do_not_count() -> None:
    measured = np.array([0.0, 1.0, np.nan, 2.0])
    assert fit_percent(measured, np.array([0.0, 1.0, 9.0, 2.0])) == pytest.approx(100.0)
    assert fit_percent(np.full(3, np.nan), np.zeros(3)) is None
    assert fit_percent(np.ones(3), np.zeros(3)) is None
