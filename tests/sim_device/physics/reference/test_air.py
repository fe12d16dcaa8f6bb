"""ISO 6358 at its limits."""

from __future__ import annotations

from itertools import pairwise

import pytest

from sim_device.physics.reference.air import flow, shape

C, B, LAMINAR = 2.0e-9, 0.3, 0.99


def test_below_the_critical_ratio_the_flow_is_choked() -> None:
    choked = C * 1.185 * 3.0e5
    for downstream in (0.0, 0.5e5, 0.3 * 3.0e5):
        assert flow(C, B, LAMINAR, 3.0e5, downstream) == pytest.approx(choked, rel=1e-12)
    assert flow(C, B, LAMINAR, 3.0e5, 0.31 * 3.0e5) < choked


def test_choked_flow_is_in_proportion_to_the_upstream_pressure() -> None:
    assert flow(C, B, LAMINAR, 6.0e5, 1.0e5) == pytest.approx(2.0 * flow(C, B, LAMINAR, 3.0e5, 0.5e5))


def test_nothing_flows_between_equal_pressures_and_the_sign_is_the_direction() -> None:
    assert flow(C, B, LAMINAR, 2.0e5, 2.0e5) == 0.0
    assert flow(C, B, LAMINAR, 2.0e5, 1.7e5) == -flow(C, B, LAMINAR, 1.7e5, 2.0e5) > 0.0


def test_the_share_falls_steadily_and_without_a_step() -> None:
    ratios = [k / 10000.0 for k in range(10001)]
    shares = [shape(ratio, B, LAMINAR) for ratio in ratios]
    drops = [before - after for before, after in pairwise(shares)]
    assert min(drops) >= 0.0
    assert max(drops) < 0.002
    assert (shares[0], shares[-1]) == (1.0, 0.0)


def test_subsonic_flow_is_a_quarter_ellipse() -> None:
    assert shape(0.65, B, LAMINAR) == pytest.approx((1.0 - 0.5**2) ** 0.5)


def test_small_differences_flow_in_proportion() -> None:
    one, two = (flow(C, B, LAMINAR, 2.0e5, 2.0e5 - drop) for drop in (100.0, 200.0))
    assert two == pytest.approx(2.0 * one, rel=1e-9)
