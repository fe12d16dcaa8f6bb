"""Modbus TCP: every answer carries the number of its request, so a late one is recognised and dropped.

Source: Modbus Messaging on TCP/IP Implementation Guide V1.0b, section 3.1.3 (MBAP header).
"""

from __future__ import annotations

import struct

from hal.clock import Clock, RealClock
from hal.errors import PortFault, WireFault
from hal.pdu import Request
from hal.reply import Reply, accept, with_retries
from hal.stats import BusStats
from hal.transport import Transport

_HEADER = 7


class TcpBus:
    """Requests over a Modbus TCP connection. `clock` stamps, `wire` waits."""

    def __init__(
        self, transport: Transport, clock: Clock, *, timeout_s: float = 0.5, wire: Clock | None = None, name: str = ""
    ) -> None:
        self._stats = BusStats()
        self._transport = transport
        self._clock = clock
        self._wire = wire or RealClock()
        self._timeout_s = timeout_s
        self._name = name
        self._number = 0
        self._data = b""

    @property
    def stats(self) -> BusStats:
        return self._stats

    def open(self) -> None:
        self._data = b""
        self._transport.open()

    def close(self) -> None:
        self._transport.close()

    def transact(self, request: Request, retries: int = 0) -> Reply:
        return with_retries(lambda: self._once(request), retries, self._stats)

    def _once(self, request: Request) -> Reply:
        self._number = (self._number + 1) & 0xFFFF
        frame = struct.pack(">HHHB", self._number, 0, len(request.pdu) + 1, request.unit) + request.pdu
        sent_s = self._clock.now_s()
        self._transport.write(frame)
        deadline_s = self._wire.now_s() + self._timeout_s
        while (left_s := deadline_s - self._wire.now_s()) > 0.0:
            self._data += self._transport.read(left_s)
            while (message := self._message()) is not None:
                number, unit, pdu = message
                if number != self._number:
                    self._stats.late_bytes += len(pdu) + _HEADER
                    continue
                if unit != request.unit or not request.accepts(pdu):
                    continue  # the right number with the wrong contents: no answer
                return accept(request, Reply(pdu, sent_s, self._clock.now_s()), self._stats, self._name)
        self._stats.timeouts += 1
        raise WireFault(
            f"unit {request.unit} on {self._name}: no answer within {self._timeout_s:g} s; "
            "check the unit id and whether this is Modbus TCP (rtu+tcp:// for a gateway that passes RTU frames)",
            sent=frame,
            received=self._data,
            waited_s=self._timeout_s,
        )

    def _message(self) -> tuple[int, int, bytes] | None:
        """The next whole message as (number, unit, PDU). Raises: `PortFault` when the stream is not Modbus TCP."""
        if len(self._data) < _HEADER:
            return None
        number, protocol, length, unit = struct.unpack(">HHHB", self._data[:_HEADER])
        if protocol != 0 or not 3 <= length <= 254:
            # A stream without frame borders cannot be found again: the connection has to be made anew.
            raise PortFault(f"port {self._name} does not speak Modbus TCP (got {self._data[:8].hex(' ')})")
        if len(self._data) < 6 + length:
            return None
        pdu = self._data[_HEADER : 6 + length]
        self._data = self._data[6 + length :]
        return number, unit, pdu
