"""Modbus TCP: every answer carries the number of its request, so a late one is recognised and dropped.

The stream has no borders but the lengths in its headers. When an answer was cut, what follows would be read from its
middle on; so a connection that is out of step is given up, and the next request is asked on a new one.

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
        self._answered = False  # somebody there has spoken Modbus TCP
        self._missed = False  # an answer on this connection has not come yet: half of one may come at any time
        self._lost = False  # nobody knows where in the stream the next header is

    @property
    def stats(self) -> BusStats:
        return self._stats

    def open(self) -> None:
        self._data, self._answered, self._missed, self._lost = b"", False, False, False
        self._transport.open()

    def close(self) -> None:
        self._transport.close()

    def transact(self, request: Request, retries: int = 0) -> Reply:
        return with_retries(lambda: self._once(request), retries, self._stats)

    def _once(self, request: Request) -> Reply:
        if self._lost:
            self._connect_anew()
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
                self._answered = True
                return accept(request, Reply(pdu, sent_s, self._clock.now_s()), self._stats, self._name)
        raise self._silence(request, frame)

    def _silence(self, request: Request, frame: bytes) -> WireFault:
        """No answer in time. Half of one may be there: its rest may never come, and then it would be the next one's."""
        self._lost, self._missed = bool(self._data), True
        self._stats.timeouts += 1
        self._stats.damaged += self._lost
        said = f"only {len(self._data)} bytes of an answer" if self._data else "no answer"
        return WireFault(
            f"unit {request.unit} on {self._name}: {said} within {self._timeout_s:g} s; "
            "check the unit id and whether this is Modbus TCP (rtu+tcp:// for a gateway that passes RTU frames)",
            sent=frame,
            received=self._data,
            waited_s=self._timeout_s,
        )

    def _connect_anew(self) -> None:
        self._stats.late_bytes += len(self._data)
        self._data = b""
        self._transport.close()
        self._transport.open()
        self._lost, self._missed = False, False
        self._stats.resyncs += 1

    def _message(self) -> tuple[int, int, bytes] | None:
        """The next whole message as (number, unit, PDU).

        Raises: `PortFault` when this never was Modbus TCP, `WireFault` when it no longer is.
        """
        if len(self._data) < _HEADER:
            return None
        number, protocol, length, unit = struct.unpack(">HHHB", self._data[:_HEADER])
        if protocol != 0 or not 3 <= length <= 254:
            self._lost = True
            got = self._data[:8].hex(" ")
            if not (self._answered or self._missed):
                raise PortFault(f"port {self._name} does not speak Modbus TCP (got {got})")
            self._stats.damaged += 1
            raise WireFault(f"port {self._name} is out of step (got {got}); it is connected anew", received=self._data)
        if len(self._data) < 6 + length:
            return None
        pdu = self._data[_HEADER : 6 + length]
        self._data = self._data[6 + length :]
        return number, unit, pdu
