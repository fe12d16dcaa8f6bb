"""Every profile that comes with the program can be emulated, and the HAL reads back what the valve did."""

from __future__ import annotations

import pytest

from hal.clock import SteppedClock
from hal.modbus_bench import ModbusBench
from hal.profile import load_profile, profile_names
from hal.sample import Quality
from sim_device.server import VirtualDevice
from sim_device.valve import Outputs


class Midway:
    """A valve at half its travel whose pressure is what it is told."""

    def __init__(self, travel_in: float) -> None:
        self._position_in = 0.5 * travel_in

    def advance(self, to_time_s: float, command: float) -> Outputs:
        return Outputs(pressure_psi=command, position_in=self._position_in, supply_psi=80.0, temperature_c=21.5)


def test_there_are_profiles() -> None:
    assert "virtual" in profile_names()


@pytest.mark.parametrize("name", profile_names())
def test_command_out_and_readings_back(name: str) -> None:
    profile, clock = load_profile(name), SteppedClock()
    limits, signals = profile.limits, profile.signals
    command = limits.command_min + 0.6 * (limits.command_max - limits.command_min)
    device = VirtualDevice(profile, Midway(profile.travel_in), clock)
    with device, ModbusBench(profile, device.port, clock, pacing="none") as bench:
        sample = bench.exchange(command)
        assert device.rig.command == pytest.approx(command, abs=signals.command.resolution() + 1e-5)
        step_in = signals.position.resolution() * profile.travel_in / 5.0 + 1e-4
        assert sample.position.value == pytest.approx(0.5 * profile.travel_in, abs=step_in)
        assert sample.position.quality is Quality.GOOD
        if sample.pressure is not None and signals.pressure is not None:
            assert sample.pressure.value == pytest.approx(command, abs=2 * signals.command.resolution() + 1e-3)
        if sample.readback_psi is not None:
            assert sample.readback_psi == pytest.approx(command, abs=2 * signals.command.resolution() + 1e-5)
    assert device.rig.command == pytest.approx(profile.safe_command, abs=signals.command.resolution())
