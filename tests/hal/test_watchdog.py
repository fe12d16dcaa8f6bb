"""The device's dead man's handle in registers of its own, and in coils as ICP DAS has it."""

from __future__ import annotations

import pytest

from hal.clock import SteppedClock
from hal.errors import SafetyTrip
from hal.fake import FirstOrder
from hal.modbus_bench import ModbusBench
from hal.profile import load_profile
from sim_device.server import VirtualDevice
from sim_device.valve import Outputs


class Lag:
    def __init__(self) -> None:
        self.valve = FirstOrder()

    def advance(self, to_time_s: float, command: float) -> Outputs:
        pressure, position = self.valve(to_time_s, command)
        return Outputs(pressure, position, 60.0, 21.5)


@pytest.mark.parametrize("name", ["virtual", "positioner", "icpdas"])
def test_armed_while_we_are_there_tripped_when_we_vanish_cleared_by_a_person(name) -> None:
    profile = load_profile(name)
    clock = SteppedClock()
    device_profile = profile.device_of(profile.signals.command)
    assert device_profile.watchdog is not None
    timeout_s = device_profile.watchdog.timeout_s
    with VirtualDevice(profile, Lag(), clock) as device:
        bench = ModbusBench(profile, device.port, clock, pacing="none", margin_s=1.0)
        bench.__enter__()
        bench.exchange(9.0)
        assert device.rig.watchdog.timeout_s == pytest.approx(timeout_s)
        clock.sleep_until(timeout_s - 0.01)
        bench.exchange(9.0)
        bench.bus.close()  # as after kill -9: no safe command, the watchdog stays armed
        clock.sleep_until(clock.now_s() + timeout_s + 0.01)

        with pytest.raises(SafetyTrip, match="lostmotion set --acknowledge"):
            ModbusBench(profile, device.port, clock, pacing="none", margin_s=1.0).__enter__()
        assert device.rig.command == pytest.approx(profile.safe_command)
        with ModbusBench(profile, device.port, clock, pacing="none", margin_s=1.0, acknowledge=True) as again:
            again.exchange(9.0)
            assert device.rig.command == pytest.approx(9.0, abs=1e-3)
        clock.sleep_until(clock.now_s() + 100.0)  # let go: it does not run out behind our back
        with ModbusBench(profile, device.port, clock, pacing="none", margin_s=1.0):
            pass
