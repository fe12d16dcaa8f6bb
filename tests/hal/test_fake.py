"""The fake must be as strict as the real thing, or tests that use it prove nothing."""

from __future__ import annotations

import math

import pytest

from hal.bench import Bench
from hal.clock import SteppedClock
from hal.errors import BadInput, PortFault, WireFault
from hal.fake import FakeBench, FirstOrder
from hal.sample import Quality


def test_it_is_a_bench() -> None:
    bench: Bench = FakeBench(SteppedClock())
    with bench as open_bench:
        assert open_bench.exchange(3.0).commanded_psi == 3.0


def test_the_response_sees_the_command_that_was_in_force() -> None:
    seen = []
    clock = SteppedClock()
    with FakeBench(clock, response=lambda t, c: (seen.append((t, c)), (0.0, 0.0))[1]) as bench:
        bench.exchange(5.0)
        clock.sleep_until(0.5)
        bench.exchange(7.0)
    assert seen == [(0.0, 0.0), (0.5, 5.0)]


def test_the_first_order_valve_follows_exactly() -> None:
    valve = FirstOrder(tau_s=0.5)
    valve(0.0, 0.0)
    pressure, _ = valve(1.0, 10.0)
    assert pressure == pytest.approx(10.0 * (1 - math.exp(-2)))


def test_the_script_is_followed() -> None:
    with FakeBench(SteppedClock(), script={1: Quality.MISSING, 2: WireFault("cut"), 3: Quality.STALE}) as bench:
        assert bench.exchange(1.0).position.quality is Quality.GOOD
        lost = bench.exchange(1.0)
        assert math.isnan(lost.position.value)
        assert lost.pressure is not None
        assert math.isnan(lost.pressure.value)
        with pytest.raises(WireFault):
            bench.exchange(1.0)
        stale = bench.exchange(1.0)
        assert (stale.position.quality, stale.sequence) == (Quality.STALE, 3)
        assert not math.isnan(stale.position.value)


def test_it_is_safe_after_it_was_left_and_cannot_be_used_closed_or_twice() -> None:
    bench = FakeBench(SteppedClock())
    with pytest.raises(PortFault):
        bench.exchange(1.0)
    with bench:
        bench.exchange(9.0)
        with pytest.raises(BadInput):
            bench.exchange(math.nan)
        with pytest.raises(PortFault):
            bench.__enter__()
    assert (bench.held, bench.open, bench.reasons) == (0.0, False, ["the bench is left"])
