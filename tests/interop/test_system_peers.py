"""Peers that come as system packages: libmodbus as master and as slave, mbpoll as master. Run by `make interop`."""

from __future__ import annotations

import shutil
import struct
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from bench.libmodbus import INSTALL, LibModbus, library
from hal.clock import RealClock, SteppedClock
from hal.modbus_bench import ModbusBench
from hal.profile import load_profile
from hal.sample import Quality
from sim_device.server import VirtualDevice
from tests.interop.peers import foreign_profile, serial_cable
from tests.interop.test_masters import Follower

pytestmark = pytest.mark.interop
needs_libmodbus = pytest.mark.skipif(library() is None, reason=INSTALL)
needs_mbpoll = pytest.mark.skipif(shutil.which("mbpoll") is None, reason="on Debian and Ubuntu: apt-get install mbpoll")


@pytest.fixture
def device() -> Iterator[VirtualDevice]:
    with VirtualDevice(load_profile("virtual"), Follower(), SteppedClock()) as device:
        yield device


def words(value: float) -> list[int]:
    return list(struct.unpack(">2H", struct.pack(">f", value)))


@needs_libmodbus
def test_libmodbus_reads_and_writes_the_virtual_device(device: VirtualDevice) -> None:
    with LibModbus(device.port, 1) as master:
        master.write(0, words(7.25))
        assert master.read(16, 2) == words(7.25)
        assert master.write_and_read(0, words(3.5), 16, 9)[4:6] == words(3.5)
        with pytest.raises(OSError, match="Illegal data address"):
            master.read(500, 1)


@contextmanager
def libmodbus_slave() -> Iterator[str]:
    stop = threading.Event()
    with serial_cable() as (near, far), LibModbus(far, 17) as slave:
        thread = threading.Thread(target=slave.serve, args=(stop,), daemon=True)
        thread.start()
        try:
            yield near
        finally:
            stop.set()
            thread.join(10.0)


@needs_libmodbus
@pytest.mark.parametrize("fc23", [True, False], ids=["one transaction", "write and read"])
def test_the_hal_drives_a_slave_of_libmodbus(fc23: bool) -> None:
    # libmodbus' slave has no function 8, so the profile resynchronises by reads of a length used nowhere else.
    profile = foreign_profile(fc23=fc23, resync={"method": "read", "address": 0, "count": 16})
    with libmodbus_slave() as port:
        with ModbusBench(profile, port, RealClock()) as bench:
            bench.exchange(7.25)
            sample = bench.exchange(9.5)
            assert sample.readback_psi == 9.5
            assert sample.position.quality is Quality.GOOD
        with ModbusBench(profile, port, RealClock(), read_only=True) as bench:
            assert bench.observe().readback_psi == 0.0


@needs_mbpoll
def test_mbpoll_reads_and_writes_the_virtual_device(device: VirtualDevice) -> None:
    common = ["mbpoll", "-m", "rtu", "-a", "1", "-b", "115200", "-P", "none", "-0", "-1", "-B"]
    assert "Written 1 reference" in output(*common, "-t", "4:float", "-r", "0", device.port, "7.25")
    assert "7.25" in output(*common, "-t", "4:float", "-r", "16", "-c", "1", device.port)


def output(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=20).stdout
