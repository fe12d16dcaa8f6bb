"""When a valve counts as settled."""

from __future__ import annotations

import math

import numpy as np

from control.settle import SettleDetector, SettleRule


def settles_after(position: list[float], period_s: float = 0.1, pressure: float | None = 9.0) -> float | None:
    detector = SettleDetector()
    for i, x in enumerate(position):
        if detector.update(i * period_s, x, pressure):
            return i * period_s
    return None


def test_a_valve_at_rest_settles_after_one_window() -> None:
    assert settles_after([0.1] * 100) == SettleRule().window_s


def test_a_first_order_tail_has_to_die_out() -> None:
    tail = [0.0475 * (1.0 - math.exp(-0.1 * i / 2.7)) for i in range(400)]
    when = settles_after(tail)
    assert when is not None
    assert abs(tail[round(when / 0.1)] - 0.0475) < 0.0006
    assert 8.0 < when < 20.0


def test_noise_does_not_keep_it_waiting() -> None:
    noise = 0.0006 * np.random.default_rng(1).standard_normal(200)
    when = settles_after((0.1 + noise).tolist())
    assert when is not None
    assert when < 9.0


def test_a_creeping_valve_never_settles() -> None:
    assert settles_after([0.001 * i * 0.1 for i in range(600)]) is None


def test_a_pressure_that_still_moves_counts_too() -> None:
    detector = SettleDetector()
    assert not any(detector.update(0.1 * i, 0.1, 9.0 + 0.005 * i) for i in range(300))


def test_missing_readings_are_left_out_and_reset_forgets() -> None:
    detector = SettleDetector()
    for i in range(60):
        assert not detector.update(0.1 * i, 0.1, None)
    assert not detector.update(6.0, math.nan, None)
    assert detector.update(6.1, 0.1, None)
    detector.reset()
    assert not detector.update(6.2, 0.1, None)
