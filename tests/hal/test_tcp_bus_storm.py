"""The invariant over Modbus TCP: whatever a gateway does, an answer that is handed out is the answer to its request."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager

import pytest

from hal.clock import RealClock
from hal.errors import DeviceRefused, WireFault
from hal.pdu import read_registers, write_and_read
from hal.port import parse_port
from hal.tcp_bus import TcpBus
from hal.transport import TcpTransport
from sim_device.diagnostics import Diagnostics
from sim_device.faults import WireFaults
from sim_device.faulty_stream import FaultyStream
from sim_device.identity import Identity
from sim_device.line import Line, Unit
from sim_device.listener import Listener
from sim_device.pdu import Server

TIMEOUT_S = 0.012


class Coded:
    """Register n holds n."""

    def check_read(self, table: int, address: int, count: int) -> None: ...

    def read(self, table: int, address: int, count: int) -> Sequence[int]:
        return range(address, address + count)

    def check_write(self, table: int, address: int, values: Sequence[int]) -> None: ...

    def write(self, table: int, address: int, values: Sequence[int]) -> None: ...


@contextmanager
def bus_through(faults: WireFaults) -> Iterator[TcpBus]:
    diagnostics = Diagnostics()
    unit = Unit(Server(Coded(), diagnostics, Identity({0: "coded"})), diagnostics, lambda: None)
    line, stream = Line({1: unit}), FaultyStream(faults)
    with closing(Listener("tcp://127.0.0.1:0", lambda _: None, line, allow_remote=False, faults=stream)) as listener:
        transport = TcpTransport(parse_port(listener.url))
        bus = TcpBus(transport, RealClock(), timeout_s=TIMEOUT_S, name=listener.url)
        bus.open()
        with closing(bus):
            yield bus


def outcomes(bus: TcpBus, count: int) -> tuple[int, int, int]:
    """(right, raised, silently wrong) of reads at random addresses, alone and behind a write."""
    chance = random.Random(5)
    tally = [0, 0, 0]
    for _ in range(count):
        address, size = chance.randrange(60_000), chance.choice((1, 2, 4, 9))
        ask = chance.choice((read_registers(1, 3, address, size), write_and_read(1, 7, (1,), address, size)))
        try:
            words = bus.transact(ask).words
        except (WireFault, DeviceRefused):
            tally[1] += 1
        else:
            tally[0 if words == tuple(range(address, address + size)) else 2] += 1
    return tally[0], tally[1], tally[2]


MIX = {"late": 0.05, "drop": 0.02, "truncate": 0.03, "wrong_transaction": 0.03, "exception": 0.01, "wrong_unit": 0.02,
       "wrong_function": 0.02, "exception_burst": 4}  # fmt: skip


def test_a_storm_of_faults_gives_nothing_wrong() -> None:
    with bus_through(WireFaults(**MIX, timeout_s=TIMEOUT_S, seed=3)) as bus:
        right, raised, wrong = outcomes(bus, 700)
        assert wrong == 0
        assert right > 300, f"the connection must be usable all the same ({right} right, {raised} raised)"
        assert bus.stats.resyncs > 0, "cut answers leave the stream out of step"


@pytest.mark.parametrize("name", ["truncate", "wrong_transaction", "wrong_unit", "wrong_function", "drop"])
def test_a_gateway_that_is_always_wrong_gives_errors_and_nothing_else(name: str) -> None:
    with bus_through(WireFaults(**{name: 1.0}, timeout_s=TIMEOUT_S, seed=1)) as bus:
        assert outcomes(bus, 20) == (0, 20, 0)


def test_late_and_cut_answers_together_give_nothing_wrong() -> None:
    faults = WireFaults(late=0.5, late_to=2.0, truncate=0.5, timeout_s=TIMEOUT_S, seed=2)
    with bus_through(faults) as bus:
        _, _, wrong = outcomes(bus, 150)
        assert wrong == 0
