"""Looking for a device on a line: which unit, which speed, and how long it thinks."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from hal.clock import Clock, RealClock
from hal.errors import WireFault
from hal.line import RtuLine
from hal.pdu import read_registers
from hal.port import PortName
from hal.profile import Serial
from hal.transport import SettingRefused, make_transport

BAUDS = (9600, 19200, 38400, 57600, 115200)


@dataclass(frozen=True, slots=True)
class Found:
    """A unit that answered. `turnaround_ms`: median time beyond what the bytes take on the wire.

    NaN where the answers are as fast as the wire or faster: on a line without bits (pseudo-terminal, TCP), or when an
    adapter runs at another speed.
    """

    unit: int
    baud: int
    parity: str
    stop_bits: int
    answer: str
    turnaround_ms: float
    worst_ms: float


def settings_to_try(bauds: Iterable[int], parities: Iterable[str]) -> list[Serial]:
    """Line settings in the order to try; always one stop bit, as most devices have."""
    return [
        Serial.model_validate({"baud": baud, "parity": parity, "stop_bits": 1}) for baud in bauds for parity in parities
    ]


def probe(
    port: PortName,
    settings: Iterable[Serial],
    units: Iterable[int],
    *,
    timeout_s: float = 0.15,
    rounds: int = 20,
    said: Callable[[str], None] = lambda _: None,
    clock: Clock | None = None,
) -> Iterator[Found]:
    """Asks every unit at every setting for one register; any intact answer, an exception too, is a find.

    Only function 3 is sent, which changes nothing. `said` is told what is being tried. Raises: `PortFault`.
    """
    clock = clock or RealClock()
    for serial in settings:
        said(f"trying {serial.baud} 8{serial.parity}{serial.stop_bits}")
        line = RtuLine(make_transport(port, serial), serial, clock, name=port.text)
        try:
            line.open()
        except SettingRefused:
            said(f"  not possible on {port.text}")
            continue
        try:
            for unit in units:
                found = _ask(line, unit, timeout_s, rounds)
                if found is not None:
                    yield found
        finally:
            line.close()


def _ask(line: RtuLine, unit: int, timeout_s: float, rounds: int) -> Found | None:
    serial, request = line.serial, read_registers(unit, 3, 0, 1)
    try:
        line.settle(timeout_s)
        first = line.ask(request, timeout_s)
    except WireFault:
        return None
    answer = f"exception {first.pdu[1]}" if first.refused else "register 0 read"
    latencies_s = []
    for _ in range(rounds):
        try:
            reply = line.ask(request, timeout_s)
        except WireFault:
            continue
        wire_s = (len(request.pdu) + len(reply.pdu) + 6) * serial.char_s
        latencies_s.append(reply.latency_s - wire_s)
    middle, worst = math.nan, math.nan
    if latencies_s and statistics.median(latencies_s) > 0.0:
        middle, worst = statistics.median(latencies_s), max(latencies_s)
    return Found(unit, serial.baud, serial.parity, serial.stop_bits, answer, 1e3 * middle, 1e3 * worst)
