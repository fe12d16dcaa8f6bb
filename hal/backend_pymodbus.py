"""The second backend: pymodbus carries the bytes, and everything it hands back is checked as if it were a stranger's.

pymodbus (3.16) by itself takes late answers, answers to other functions, and answers of another length for the answer.
So its asynchronous client runs in a thread of its own, without retries; a call is never cancelled from outside; the
bytes behind every answer go through our own framer as well, which takes exact matches only; and the bus above wins
trust back after a fault exactly as it does on the native line.
"""

from __future__ import annotations

import asyncio
import logging
import threading
from collections.abc import Coroutine
from typing import Any

from hal.clock import Clock, RealClock
from hal.errors import PortFault, WireFault
from hal.framing import describe, find_reply, seal
from hal.pdu import Request
from hal.port import PortName
from hal.profile import Serial
from hal.reply import Reply
from hal.stats import BusStats
from hal.transport import make_transport, parity_of

_OPEN_S = 3.0


class PymodbusLine:
    """What `RtuLine` is, with pymodbus underneath. A line with local echo is not supported here."""

    def __init__(self, port: PortName, serial: Serial, clock: Clock, *, wire: Clock | None = None) -> None:
        self.stats = BusStats()
        self.local_echo: bool | None = False
        self.name = port.text
        self.serial = serial
        self._port = port
        self._clock = clock
        self._wire = wire or RealClock()
        self._client: Any = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._asking = False
        self._heard = b""  # what arrived since the request went out
        self._stray = 0  # bytes while nothing was asked

    def open(self) -> None:
        """Raises: `PortFault`; our own transport finds out why, as pymodbus only says that it did not work."""
        trial = make_transport(self._port, self.serial)
        trial.open()
        trial.close()
        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # what it complains about is counted and reported here
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="pymodbus", daemon=True)
        self._thread.start()
        if not self._run(self._connect(), _OPEN_S):
            self.close()
            raise PortFault(f"port {self.name} cannot be opened by pymodbus; try the native backend")

    def close(self) -> None:
        loop, thread = self._loop, self._thread
        if loop is None or thread is None:
            return
        if self._client is not None:
            loop.call_soon_threadsafe(self._client.close)
        loop.call_soon_threadsafe(loop.stop)
        thread.join(2.0)
        loop.close()
        self._client = self._loop = self._thread = None

    def ask(self, request: Request, timeout_s: float) -> Reply:
        """Raises: `WireFault` without an answer that fits, `PortFault` when the port is gone."""
        sent_s = self._clock.now_s()
        self._heard, self._asking = b"", True
        try:
            answered = self._run(self._execute(request, timeout_s), timeout_s + _OPEN_S)
        finally:
            self._asking = False
        received_s = self._clock.now_s()
        found = self._own_judgement(request) if answered else None
        if found is not None:
            self.stats.noise_bytes += found[1]
            return Reply(found[0], sent_s, received_s, found[1])
        self.stats.timeouts += 1
        self.stats.damaged += bool(self._heard)
        raise WireFault(
            f"unit {request.unit} on {self.name}: {describe(self._heard, request)} within {timeout_s:.3g} s; "
            "check power, wiring, unit id and baud (`lostmotion probe` looks for them)",
            sent=seal(request.unit, request.pdu),
            received=self._heard,
            waited_s=timeout_s,
        )

    def _own_judgement(self, request: Request) -> tuple[bytes, int] | None:
        """The PDU that our own rules find in what pymodbus heard, and how many bytes followed it."""
        data = self._heard
        if self._port.kind == "tcp":  # the number of the request has been compared by pymodbus
            pdu = data[7:]
            return (pdu, 0) if data[6:7] == bytes((request.unit,)) and request.accepts(pdu) else None
        found = find_reply(data, request)
        return None if found is None else (data[found[0] + 1 : found[1] - 2], len(data) - found[1])

    def strays(self) -> int:
        count, self._stray = self._stray, 0
        return count

    def settle(self, limit_s: float) -> int:
        """Waits until nothing arrived for a moment; returns the number of bytes that came meanwhile."""
        pause_s, count = max(0.002, 40 * self.serial.char_s), 0
        give_up_s = self._wire.now_s() + limit_s
        while self._wire.now_s() < give_up_s:
            self._wire.sleep_until(self._wire.now_s() + pause_s)
            new = self.strays()
            if not new:
                break
            count += new
        return count

    async def _connect(self) -> bool:
        from pymodbus import FramerType
        from pymodbus.client import AsyncModbusSerialClient, AsyncModbusTcpClient

        if self._port.kind == "serial":
            s = self.serial
            self._client = AsyncModbusSerialClient(
                self._port.text,
                baudrate=s.baud,
                parity=parity_of(self._port.text, s),
                stopbits=s.stop_bits,
                retries=0,
                reconnect_delay=0,
                trace_packet=self._trace,
            )
        else:
            framer = FramerType.SOCKET if self._port.kind == "tcp" else FramerType.RTU
            self._client = AsyncModbusTcpClient(
                self._port.host,
                port=self._port.number,
                framer=framer,
                retries=0,
                reconnect_delay=0,
                trace_packet=self._trace,
            )
        self._client.set_max_no_responses(1 << 30)  # whether to go on is decided by the safety layer
        return bool(await self._client.connect())

    async def _execute(self, request: Request, timeout_s: float) -> bool:
        """Whether pymodbus took something for an answer."""
        from pymodbus.exceptions import ConnectionException, ModbusException
        from pymodbus.pdu import DecodePDU

        message = DecodePDU(True).decode(request.pdu)
        if message is None:
            raise PortFault(f"pymodbus does not know function {request.function}; use the native backend")
        message.dev_id = request.unit
        self._client.ctx.comm_params.timeout_connect = timeout_s
        try:
            await self._client.execute(False, message)
        except ConnectionException as error:
            raise PortFault(f"port {self.name} is gone: unplugged, or the other end has closed it") from error
        except ModbusException:
            return False
        return True

    def _trace(self, sending: bool, data: bytes) -> bytes:
        if not sending and self._asking:
            self._heard = data  # pymodbus shows all that it holds, again and again
        elif not sending:
            self._stray += len(data)
        return data

    def _run(self, work: Coroutine[Any, Any, bool], timeout_s: float) -> bool:
        if self._loop is None:
            work.close()
            raise PortFault(f"port {self.name} is not open")
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(timeout_s)
