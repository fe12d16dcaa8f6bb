"""A port that is pulled out and plugged in again: a real pseudo-terminal that closes and comes back under its name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from hal.clock import SteppedClock
from hal.errors import BenchFault, PortFault
from hal.modbus_bench import ModbusBench
from hal.profile import Profile, load_profile
from hal.reopen import Reopening
from hal.safety import SafeBench
from sim_device.physics.catalog import make_physics
from sim_device.server import VirtualDevice

VIRTUAL = load_profile("virtual")


class Meanwhile(SteppedClock):
    """While somebody waits, things happen: one after the other, and the last again and again."""

    def __init__(self, *happens: Callable[[], object]) -> None:
        super().__init__()
        self._happens = list(happens)

    def sleep_until(self, time_s: float) -> None:
        super().sleep_until(time_s)
        if self._happens:
            self._happens.pop(0)()


def plugged(profile: Profile, folder: Path) -> VirtualDevice:
    return VirtualDevice(profile, make_physics("thesis", 1), SteppedClock(), link=folder / "port")


def bench_at(
    device: VirtualDevice, reopening: Reopening, backend: str = "native", profile: Profile = VIRTUAL
) -> ModbusBench:
    return ModbusBench(profile, device.port, SteppedClock(), pacing="none", backend=backend, reopening=reopening)


@pytest.mark.parametrize("backend", ["native", "pymodbus"])
def test_the_valve_is_vented_through_the_port_that_came_back(tmp_path: Path, backend: str) -> None:
    said: list[str] = []
    with plugged(VIRTUAL, tmp_path) as device:
        clock = Meanwhile(lambda: None, device.__enter__)
        bench = bench_at(device, Reopening(10.0, said.append, clock), backend)
        with pytest.raises(PortFault, match="is gone"), SafeBench(bench, VIRTUAL.limits, SteppedClock()) as safe:
            safe.exchange(12.0)
            assert device.rig.command == 12.0
            device.close()
            safe.exchange(12.0)
        assert safe.way_out is not None
        assert safe.way_out.safe
        assert safe.way_out.status == "fail"
        assert device.rig.command == 0.0
    assert "is gone" in said[0]
    assert "for 10 s" in said[0]
    assert said[1:] == ["the port is open again"]


def test_a_port_that_stays_away_is_given_up_once_and_said_to_be_unsafe(tmp_path: Path) -> None:
    said: list[str] = []
    with plugged(VIRTUAL, tmp_path) as device:
        bench = bench_at(device, Reopening(10.0, said.append, clock := SteppedClock()))
        with (
            pytest.raises(BenchFault, match=r"did NOT confirm.*is gone"),
            SafeBench(bench, VIRTUAL.limits, SteppedClock()) as safe,
        ):
            safe.exchange(12.0)
            device.close()
            safe.exchange(12.0)
        assert 10.0 <= clock.now_s() < 10.5, "one attempt, however often the way out asks for it"
        assert said[-1] == "the port did not come back"


def test_nothing_is_written_to_another_device_that_took_the_name(tmp_path: Path) -> None:
    content = VIRTUAL.model_dump(mode="json", exclude_none=True)
    content["devices"]["bench"]["identity"] = {"objects": {"product_code": "SOMETHING-ELSE"}}
    said: list[str] = []
    with plugged(VIRTUAL, tmp_path) as device, plugged(Profile.model_validate(content), tmp_path / "..") as other:
        clock = Meanwhile(lambda: (tmp_path / "port").symlink_to(Path(other.port).resolve()))
        bench = bench_at(device, Reopening(10.0, said.append, clock))
        with (
            pytest.raises(BenchFault, match="did NOT confirm"),
            SafeBench(bench, VIRTUAL.limits, SteppedClock()) as safe,
        ):
            safe.exchange(12.0)
            device.close()
            other.rig.request_command(7.0)
            safe.exchange(12.0)
        assert other.rig.command == 7.0
    assert "is not the device of the profile" in said[1]


def test_reading_goes_on_behind_a_port_that_came_back(tmp_path: Path) -> None:
    with plugged(VIRTUAL, tmp_path) as device:
        reopening = Reopening(10.0, clock=Meanwhile(device.__enter__))
        with ModbusBench(VIRTUAL, device.port, SteppedClock(), read_only=True, reopening=reopening) as bench:
            device.close()
            with pytest.raises(PortFault) as gone:
                bench.observe()
            assert bench.reopen(gone.value)
            assert bench.observe().commanded_psi == 0.0
