"""Shapes over the position grid: heights, zeros, and what detrending takes away."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from twin.kernels.sensor import static_reading
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.model.shapes import bow, bump, detrended, swing

XI = np.linspace(0.0, 1.0, 65)


def test_bow_and_swing_are_zero_at_the_ends_and_one_high() -> None:
    assert bow(XI)[[0, 32, 64]] == pytest.approx([0.0, 1.0, 0.0])
    assert swing(XI)[[0, 32, 64]] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert np.abs(swing(np.linspace(0.0, 1.0, 1001))).max() == pytest.approx(1.0, abs=0.002)


def test_bump_is_one_high_at_its_centre_and_narrow() -> None:
    assert bump(XI, 0.5, 0.1)[32] == 1.0
    assert bump(np.array([0.6]), 0.5, 0.1)[0] == pytest.approx(np.exp(-0.5))
    assert np.isfinite(bump(XI, 0.5, 0.0)).all()


def test_detrended_shapes_say_nothing_about_offset_and_compliance() -> None:
    rest = detrended(np.square(XI) + 3.0 * XI + 2.0, XI)
    assert np.mean(rest) == pytest.approx(0.0, abs=1e-12)
    assert rest @ XI == pytest.approx(0.0, abs=1e-9)
    assert rest == pytest.approx(detrended(np.square(XI), XI))


def test_a_core_out_of_its_range_at_both_ends_is_straight_between() -> None:
    form = effect("lvdt_nonlinearity").form("leaves_range_both")
    c = Plant(DesignModel(), (Inserted("lvdt_nonlinearity", form, (-0.03, 0.02, 0.5)),)).coefficients(1.0)
    travel = DesignModel().travel
    x = travel * np.array([0.0, 0.125, 0.25, 0.5, 0.75, 0.875, 1.0])
    excess = (static_reading(x, np.zeros(7), c.sensor) - x) / travel
    assert excess == pytest.approx([0.02, 0.005, 0.0, 0.0, 0.0, -0.0075, -0.03])


def test_two_plays_share_the_motion_and_keep_the_mean_width() -> None:
    form = effect("distributed_hysteresis").form("two_plays")
    c = Plant(DesignModel(), (Inserted("distributed_hysteresis", form, (0.4, 0.5)),)).coefficients(1.0)
    assert c.weights == pytest.approx([0.4, 0.6])
    assert c.spreads[1] - c.spreads[0] == pytest.approx(0.5)
    assert c.weights @ c.spreads == pytest.approx(0.0, abs=1e-12)
