"""The units that share one line: who answers, who keeps silent, and who listens to a broadcast."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sim_device.crc import sealed
from sim_device.diagnostics import Diagnostics
from sim_device.pdu import DEVICE_FAILURE, Server

BROADCAST = 0
_BROADCAST_FUNCTIONS = frozenset((5, 6, 15, 16, 22))  # only writes make sense when nobody answers
_DIRECT = frozenset((0, 255))  # how a Modbus TCP master addresses a device that needs no unit id


@dataclass(frozen=True)
class Unit:
    """One address on the line. `heard` is told of every request for it, before it is answered (the watchdog's food)."""

    server: Server
    diagnostics: Diagnostics
    heard: Callable[[], None]


class Line:
    """Safe to use from several threads: the units answer one request at a time, as on a real line."""

    def __init__(self, units: Mapping[int, Unit]) -> None:
        self._units = dict(units)
        self._lock = threading.Lock()

    def rtu(self, frame: bytes) -> bytes | None:
        """The reply frame to an intact request frame; None where a slave keeps silent."""
        with self._lock:
            for unit in self._units.values():
                unit.diagnostics.saw_frame()
            address, pdu = frame[0], frame[1:-2]
            if address == BROADCAST:
                self._broadcast(pdu)
                return None
            reply = self._answer(address, pdu)
        return None if reply is None else sealed(bytes((address,)) + reply)

    def tcp(self, address: int, pdu: bytes) -> bytes | None:
        """The reply PDU to a request PDU that came over Modbus TCP; None for a unit that is not here."""
        with self._lock:
            if address in _DIRECT and address not in self._units:
                address = next(iter(self._units))
            return self._answer(address, pdu)

    def saw_damage(self, times: int) -> None:
        """Every unit on the line counts the disturbances it hears."""
        with self._lock:
            for unit in self._units.values():
                unit.diagnostics.saw_damage(times)

    def quiet(self, pass_time: Callable[[], object]) -> None:
        """Lets time pass for the units while nobody talks to them."""
        with self._lock:
            pass_time()

    def _answer(self, address: int, pdu: bytes) -> bytes | None:
        unit = self._units.get(address)
        if unit is None:
            return None
        unit.diagnostics.addressed(answered=True)
        return _respond(unit, pdu)

    def _broadcast(self, pdu: bytes) -> None:
        if pdu[0] not in _BROADCAST_FUNCTIONS:
            return
        for unit in self._units.values():
            unit.diagnostics.addressed(answered=False)
            _respond(unit, pdu)


def _respond(unit: Unit, pdu: bytes) -> bytes:
    """A valve whose physics cannot go on answers exception 4; the line stays alive."""
    try:
        unit.heard()
    except (ArithmeticError, ValueError):
        unit.diagnostics.refused(DEVICE_FAILURE)
        return bytes((pdu[0] | 0x80, DEVICE_FAILURE))
    return unit.server.answer(pdu)
