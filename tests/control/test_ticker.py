"""Absolute deadlines."""

from __future__ import annotations

import pytest

from control.ticker import Ticker
from hal.clock import SteppedClock


def test_deadlines_do_not_drift_with_the_work_between_them() -> None:
    clock = SteppedClock(100.0)
    ticker = Ticker(clock, 0.1)
    seen = []
    for _ in range(5):
        ticker.wait()
        seen.append(clock.now_s())
        clock.sleep_until(clock.now_s() + 0.06)
    assert seen == pytest.approx([100.0, 100.1, 100.2, 100.3, 100.4])
    assert ticker.overruns == 0


def test_a_tick_that_comes_late_says_how_late() -> None:
    clock = SteppedClock()
    ticker = Ticker(clock, 0.1)
    ticker.wait()
    clock.sleep_until(0.13)
    assert ticker.wait() == 1
    assert ticker.lateness_s == pytest.approx(0.03)
    assert ticker.skipped == 0


def test_missed_deadlines_are_left_out_and_the_phase_is_kept() -> None:
    clock = SteppedClock()
    ticker = Ticker(clock, 0.1)
    ticker.wait()
    clock.sleep_until(0.35)
    assert ticker.wait() == 3  # the deadlines at 0.1 and 0.2 are gone, that at 0.3 is served late
    assert (ticker.skipped, ticker.overruns) == (2, 1)
    ticker.wait()
    assert clock.now_s() == pytest.approx(0.4)
    assert ticker.worst_lateness_s == pytest.approx(0.25)
