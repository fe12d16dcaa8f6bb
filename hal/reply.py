"""What a bus hands back, and what a bus is."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from hal.errors import DeviceRefused, WireFault
from hal.pdu import EXCEPTIONS, Request, words_of
from hal.profile import Serial
from hal.stats import BusStats


class Reply(NamedTuple):
    """An answer: its PDU, and the bench time [s] just before the request left and just after the answer was complete.

    `rest` is the number of bytes that followed the answer without a pause; a clean line has none.
    """

    pdu: bytes
    sent_s: float
    received_s: float
    rest: int = 0

    @property
    def midpoint_s(self) -> float:
        return 0.5 * (self.sent_s + self.received_s)

    @property
    def latency_s(self) -> float:
        return self.received_s - self.sent_s

    @property
    def words(self) -> tuple[int, ...]:
        return words_of(self.pdu)

    @property
    def refused(self) -> bool:
        return self.pdu[0] >= 0x80


class Line(Protocol):
    """One question at a time; whether the answer can be trusted is decided by the bus above."""

    stats: BusStats
    local_echo: bool | None  # whether we hear ourselves; None: not known yet
    name: str
    serial: Serial

    def open(self) -> None:
        """Raises: `PortFault`."""

    def close(self) -> None: ...

    def ask(self, request: Request, timeout_s: float) -> Reply:
        """Raises: `WireFault` when no answer of exactly the right shape came in time."""

    def strays(self) -> int:
        """Takes what has arrived unasked, and tells how many bytes it was."""

    def settle(self, limit_s: float) -> int:
        """Listens until the line is quiet; returns the number of bytes that came meanwhile. Raises: `WireFault`."""


class Bus(Protocol):
    """What a bench needs of a line: one request at a time, and never somebody else's answer."""

    @property
    def stats(self) -> BusStats: ...

    def open(self) -> None:
        """Raises: `PortFault`."""

    def close(self) -> None: ...

    def transact(self, request: Request, retries: int = 0) -> Reply:
        """Sends a request up to 1 + `retries` times.

        Raises: `WireFault` without a trusted answer, `DeviceRefused` on an exception, `PortFault` on a lost port.
        """


def with_retries(once: Callable[[], Reply], retries: int, stats: BusStats) -> Reply:
    """Asks up to 1 + `retries` times, until there is an answer. Raises: what the last try raises."""
    for _ in range(retries):
        try:
            return once()
        except WireFault:
            stats.retries += 1
    return once()


def accept(request: Request, reply: Reply, stats: BusStats, port: str) -> Reply:
    """Counts a trusted answer and hands it out. Raises: `DeviceRefused` when it is an exception."""
    stats.transactions += 1
    stats.exceptions += reply.refused
    if reply.refused:
        code = reply.pdu[1]
        raise DeviceRefused(
            f"unit {request.unit} on {port} refused function {request.function}: exception {code} "
            f"({EXCEPTIONS[code]}); compare the profile's addresses and function codes with the device's manual",
            function=request.function,
            code=code,
        )
    return reply
