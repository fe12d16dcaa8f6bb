"""Slaves that nobody here wrote, on the far end of a serial line, and the profile by which the HAL drives them."""

from __future__ import annotations

import asyncio
import os
import select
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager

from hal.profile import Profile, parse_profile

# Registers of the foreign slave: 0 command and read-back, 4 sequence, 6 pressure, 8 position [in].
FOREIGN = {
    "name": "foreign",
    "travel_in": 0.5625,
    "serial": {"baud": 115200, "pacing": "none"},
    "limits": {"command_min": 0.0, "command_max": 20.0},
    "devices": {"slave": {"id": 17, "fc23": True}},
    "signals": {
        "command": {"address": 0, "type": "f32", "unit": "psi"},
        "readback": {"address": 0, "type": "f32", "unit": "psi"},
        "pressure": {"address": 6, "type": "f32", "unit": "psi"},
        "position": {"address": 8, "type": "f32", "unit": "in"},
    },
}


def foreign_profile(**device: object) -> Profile:
    """The profile of the foreign slave; `device` changes keys of its [devices.slave]."""
    return parse_profile({**FOREIGN, "devices": {"slave": {"id": 17, "fc23": True} | device}}, "foreign")


@contextmanager
def serial_cable() -> Iterator[tuple[str, str]]:
    """Two pseudo-terminals joined like the ends of a null-modem cable: the paths of both ends."""
    pairs = [os.openpty() for _ in range(2)]
    for _, slave in pairs:
        tty.setraw(slave)
    stop_read, stop_write = os.pipe()
    masters = [master for master, _ in pairs]
    other = {masters[0]: masters[1], masters[1]: masters[0]}

    def carry() -> None:
        while True:
            ready, _, _ = select.select([*masters, stop_read], [], [])
            if stop_read in ready:
                return
            for fd in ready:
                os.write(other[fd], os.read(fd, 4096))

    thread = threading.Thread(target=carry, daemon=True)
    thread.start()
    try:
        yield os.ttyname(pairs[0][1]), os.ttyname(pairs[1][1])
    finally:
        os.write(stop_write, b"x")
        thread.join()
        for fd in (stop_read, stop_write, *(fd for pair in pairs for fd in pair)):
            os.close(fd)


@contextmanager
def pymodbus_slave() -> Iterator[str]:
    """pymodbus' own serial server as a slave whose pressure follows the command; yields the master's port."""
    from pymodbus import FramerType
    from pymodbus.server import ModbusSerialServer
    from pymodbus.simulator import DataType, SimData, SimDevice

    async def follow(
        _function: int, start: int, address: int, count: int, registers: list[int], written: list[int] | None
    ) -> None:
        if written is not None and address == 0:
            registers[6 - start : 8 - start] = written[:2]

    device = SimDevice(17, simdata=[SimData(0, count=16, datatype=DataType.REGISTERS)], action=follow)
    running = threading.Event()
    stops: list[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = []

    async def serve(port: str) -> None:
        server = ModbusSerialServer(device, framer=FramerType.RTU, port=port, baudrate=115200)
        await server.serve_forever(background=True)
        stop = asyncio.Event()
        stops.append((asyncio.get_running_loop(), stop))
        running.set()
        await stop.wait()
        await server.shutdown()

    with serial_cable() as (near, far):
        thread = threading.Thread(target=lambda: asyncio.run(serve(far)), daemon=True)
        thread.start()
        assert running.wait(10.0), "the pymodbus server did not start"
        try:
            yield near
        finally:
            loop, stop = stops[0]
            loop.call_soon_threadsafe(stop.set)
            thread.join(10.0)
