"""The same questions over Modbus TCP, asked by masters that speak it."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

from bench.masters import Ours, PymodbusAsync, PymodbusSync


def _place(url: str) -> tuple[str, int]:
    host, _, port = url.removeprefix("tcp://").rpartition(":")
    return host, int(port)


class OursTcp(Ours):
    def __init__(self, port: str, timeout_s: float) -> None:
        from hal.clock import RealClock
        from hal.port import parse_port
        from hal.tcp_bus import TcpBus
        from hal.transport import TcpTransport

        self._tcp = TcpBus(TcpTransport(parse_port(port)), RealClock(), timeout_s=timeout_s, name=port)
        self._tcp.open()
        self.transact = self._tcp.transact

    @property
    def stats(self) -> dict[str, int]:
        return self._tcp.stats.as_dict()

    def close(self) -> None:
        self._tcp.close()


class PymodbusTcpSync(PymodbusSync):
    def __init__(self, port: str, timeout_s: float) -> None:
        from pymodbus.client import ModbusTcpClient

        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)
        host, number = _place(port)
        self._client = ModbusTcpClient(host, port=number, timeout=timeout_s, retries=0)  # type: ignore[assignment]
        self._client.connect()


class PymodbusTcpAsync(PymodbusAsync):
    def __init__(self, port: str, timeout_s: float) -> None:
        from pymodbus.client import AsyncModbusTcpClient

        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)
        host, number = _place(port)
        self._loop = asyncio.new_event_loop()

        async def make() -> Any:
            client = AsyncModbusTcpClient(host, port=number, timeout=timeout_s, retries=0, reconnect_delay=0.01)
            await client.connect()
            return client

        self._client = self._loop.run_until_complete(make())
