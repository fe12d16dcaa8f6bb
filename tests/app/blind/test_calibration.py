from __future__ import annotations

import numpy as np
import pytest

from app.blind.calibration import calibration, curve, error


def test_honest_claims_have_no_error() -> None:
    claims = [(0.75, True)] * 30 + [(0.75, False)] * 10
    assert error(claims) == pytest.approx(0.0)


def test_boasting_shows() -> None:
    claims = [(0.99, True)] * 50 + [(0.99, False)] * 50
    found = calibration([[claim] for claim in claims])
    assert found["ece"] == pytest.approx(0.49)
    low, high = found["ci95"]
    assert 0.35 < low < 0.49 < high < 0.62
    assert found["brier"] == pytest.approx(0.5 * 0.01**2 + 0.5 * 0.99**2)


def test_errors_in_both_directions_do_not_cancel() -> None:
    claims = [(0.95, False)] * 10 + [(0.2, True)] * 10
    assert error(claims) == pytest.approx(0.5 * 0.95 + 0.5 * 0.8)


def test_every_probability_has_a_bin() -> None:
    claims = [(p, True) for p in (0.0, 0.3, 0.95, 1.0)]
    assert sum(point["claims"] for point in curve(claims)) == 4


def test_no_claims_is_no_figure() -> None:
    assert calibration([[], []])["ece"] is None
    assert np.isnan(error([]))
