"""The same three questions asked by five masters: ours, libmodbus, pymodbus (twice) and minimalmodbus.

`read` gives the registers that the master handed out, or raises; what it raises is its own business.
"""

from __future__ import annotations

import asyncio
import logging
import time
from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable, Sequence
from typing import Any

from bench.libmodbus import LibModbus, library

UNIT = 1
BAUD = 115200
WORDS = (0x40E8, 0x0000)
Question = tuple[str, int, int]  # (kind, address, count); kind is FC03, FC16 or FC23


class Master(ABC):
    """Somebody who asks slaves over a line."""

    name = ""
    kinds: tuple[str, ...] = ("FC03", "FC16", "FC23")

    @abstractmethod
    def ask(self, question: Question) -> Sequence[int]:
        """The registers that were read; empty for a write."""

    def durations_s(self, question: Question, times: int) -> list[float]:
        """How long each of `times` repetitions took [s]."""
        return [_timed(lambda: self.ask(question)) for _ in range(times)]

    def close(self) -> None:  # noqa: B027 - most masters have nothing to close
        """Lets go of the line, where there is something to let go of."""


def _timed(action: Callable[[], object]) -> float:
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


class Ours(Master):
    name = "lostmotion"

    def __init__(self, port: str, timeout_s: float, baud: int = BAUD, pacing: str = "none") -> None:
        from hal.bus import RtuBus
        from hal.clock import RealClock
        from hal.device import Device
        from hal.line import RtuLine
        from hal.port import parse_port
        from hal.profile import Serial
        from hal.transport import make_transport

        serial = Serial.model_validate({"baud": baud, "pacing": pacing})
        line = RtuLine(make_transport(parse_port(port), serial), serial, RealClock(), name=port)
        device = Device(id=UNIT, fc23=True, turnaround_ms=0.0)
        self._bus = RtuBus(line, (device,), margin_s=timeout_s)
        self._bus.open()
        self.transact = self._bus.transact

    @property
    def stats(self) -> dict[str, int]:
        return self._bus.stats.as_dict()

    def ask(self, question: Question) -> Sequence[int]:
        from hal import pdu

        kind, address, count = question
        if kind == "FC16":
            self.transact(pdu.write_registers(UNIT, address, WORDS))
            return ()
        if kind == "FC03":
            return self.transact(pdu.read_registers(UNIT, 3, address, count)).words
        return self.transact(pdu.write_and_read(UNIT, 0, WORDS, address, count)).words

    def close(self) -> None:
        self._bus.close()


class LibModbusMaster(Master):
    name = "libmodbus (ctypes)"

    def __init__(self, port: str, timeout_s: float, baud: int = BAUD, recover: bool = False) -> None:
        self._master = LibModbus(port, UNIT, baud=baud, timeout_s=timeout_s)
        if recover:
            self.name = "libmodbus + recovery"
            self._master.recover_protocol()

    def ask(self, question: Question) -> Sequence[int]:
        kind, address, count = question
        if kind == "FC16":
            self._master.write(address, WORDS)
            return ()
        if kind == "FC03":
            return self._master.read(address, count)
        return self._master.write_and_read(0, WORDS, address, count)

    def close(self) -> None:
        self._master.__exit__(None, None, None)


def _pymodbus_call(client: Any, question: Question) -> Any:
    kind, address, count = question
    if kind == "FC16":
        return client.write_registers(address, list(WORDS), device_id=UNIT)
    if kind == "FC03":
        return client.read_holding_registers(address, count=count, device_id=UNIT)
    return client.readwrite_registers(
        read_address=address, read_count=count, write_address=0, values=list(WORDS), device_id=UNIT
    )


def _pymodbus_registers(reply: Any, question: Question) -> Sequence[int]:
    if reply.isError():
        raise OSError(str(reply))
    return reply.registers if question[0] != "FC16" else ()


class PymodbusSync(Master):
    name = "pymodbus sync"

    def __init__(self, port: str, timeout_s: float, baud: int = BAUD, retries: int = 0) -> None:
        from pymodbus.client import ModbusSerialClient

        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)
        if retries:
            self.name = f"pymodbus sync, {retries} retries"
        self._client = ModbusSerialClient(port, baudrate=baud, timeout=timeout_s, retries=retries)
        self._client.connect()

    def ask(self, question: Question) -> Sequence[int]:
        return _pymodbus_registers(_pymodbus_call(self._client, question), question)

    def close(self) -> None:
        self._client.close()  # type: ignore[no-untyped-call]


class PymodbusAsync(Master):
    name = "pymodbus async"

    def __init__(self, port: str, timeout_s: float, baud: int = BAUD, retries: int = 0) -> None:
        from pymodbus.client import AsyncModbusSerialClient

        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)
        if retries:
            self.name = f"pymodbus async, {retries} retries"
        self._loop = asyncio.new_event_loop()

        async def make() -> Any:
            client = AsyncModbusSerialClient(port, baudrate=baud, timeout=timeout_s, retries=retries)
            await client.connect()
            return client

        self._client = self._loop.run_until_complete(make())

    def ask(self, question: Question) -> Sequence[int]:
        async def one() -> Any:
            return await _pymodbus_call(self._client, question)

        return _pymodbus_registers(self._loop.run_until_complete(one()), question)

    def durations_s(self, question: Question, times: int) -> list[float]:
        """Measured inside the event loop, where its users are."""

        async def many() -> list[float]:
            durations = []
            for _ in range(times):
                began = time.perf_counter()
                answer: Awaitable[Any] = _pymodbus_call(self._client, question)
                _pymodbus_registers(await answer, question)
                durations.append(time.perf_counter() - began)
            return durations

        return self._loop.run_until_complete(many())

    def close(self) -> None:
        async def end() -> None:
            self._client.close()
            await asyncio.sleep(0.01)

        self._loop.run_until_complete(end())
        self._loop.close()


class MinimalModbus(Master):
    name = "minimalmodbus"
    kinds = ("FC03", "FC16")

    def __init__(self, port: str, timeout_s: float, baud: int = BAUD) -> None:
        import minimalmodbus

        self._instrument = minimalmodbus.Instrument(port, UNIT)
        self._instrument.serial.baudrate = baud
        self._instrument.serial.timeout = timeout_s

    def ask(self, question: Question) -> Sequence[int]:
        kind, address, count = question
        if kind == "FC16":
            self._instrument.write_registers(address, list(WORDS))
            return ()
        words: Sequence[int] = self._instrument.read_registers(address, count)
        return words

    def close(self) -> None:
        self._instrument.serial.close()


def libmodbus_there() -> bool:
    return library() is not None
