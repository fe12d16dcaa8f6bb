"""Modbus TCP against a scripted server."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from hal.clock import RealClock
from hal.errors import DeviceRefused, PortFault, WireFault
from hal.pdu import read_registers
from hal.port import parse_port
from hal.tcp_bus import TcpBus
from hal.transport import TcpTransport


def frame(number: int, unit: int, pdu: bytes) -> bytes:
    return struct.pack(">HHHB", number, 0, len(pdu) + 1, unit) + pdu


def answer(request: bytes) -> bytes:
    """The right answer of a device whose registers hold their addresses."""
    number, _, _, unit, _, address, count = struct.unpack(">HHHBBHH", request)
    words = struct.pack(f">{count}H", *range(address, address + count))
    return frame(number, unit, bytes((3, 2 * count)) + words)


@contextmanager
def bus_to(reply: Callable[[int, bytes], bytes], timeout_s: float = 1.0, connections: int = 1) -> Iterator[TcpBus]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = parse_port(f"tcp://127.0.0.1:{server.getsockname()[1]}")

        def serve() -> None:
            index = 0
            for _ in range(connections):
                peer, _ = server.accept()
                with peer:
                    while data := peer.recv(260):
                        peer.sendall(reply(index, data))
                        index += 1

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        bus = TcpBus(TcpTransport(port), RealClock(), timeout_s=timeout_s, name=port.text)
        bus.open()
        yield bus
        bus.close()
        thread.join(5.0)


def test_reads_are_numbered_and_answered() -> None:
    seen = []
    with bus_to(lambda i, data: (seen.append(data[:7]), answer(data))[1]) as bus:
        assert bus.transact(read_registers(1, 3, 100, 3)).words == (100, 101, 102)
        assert bus.transact(read_registers(7, 3, 5, 1)).words == (5,)
    assert seen == [bytes.fromhex("0001 0000 0006 01"), bytes.fromhex("0002 0000 0006 07")]


def test_a_late_answer_is_recognised_by_its_number() -> None:
    held = []

    def reply(index: int, data: bytes) -> bytes:
        held.append(answer(data))
        return b"" if index == 0 else held[0] + held[1]

    with bus_to(reply, timeout_s=0.05) as bus:
        with pytest.raises(WireFault, match="no answer within"):
            bus.transact(read_registers(1, 3, 100, 1))
        assert bus.transact(read_registers(1, 3, 200, 1)).words == (200,)
        assert bus.stats.late_bytes > 0


def test_half_an_answer_that_comes_late_is_no_proof_of_another_protocol() -> None:
    held = []

    def reply(index: int, data: bytes) -> bytes:
        held.append(answer(data))
        return b"" if index == 0 else held[0][:1] + held[1]

    with bus_to(reply, timeout_s=0.05) as bus:
        with pytest.raises(WireFault, match="no answer within"):
            bus.transact(read_registers(1, 3, 100, 1))
        with pytest.raises(WireFault, match="out of step"):
            bus.transact(read_registers(1, 3, 200, 1))


def test_an_answer_in_pieces_and_two_in_one() -> None:
    with bus_to(lambda i, data: frame(999, 1, b"\x03\x02\x00\x00") + answer(data)) as bus:
        assert bus.transact(read_registers(1, 3, 8, 2)).words == (8, 9)


@pytest.mark.parametrize("wrong", [b"\x04\x02\x00\x07", b"\x03\x04\x00\x07\x00\x08", b"\x03\x02\x00"])
def test_the_right_number_with_the_wrong_contents_is_no_answer(wrong) -> None:
    with (
        bus_to(lambda i, data: frame(1, 1, wrong), timeout_s=0.05) as bus,
        pytest.raises(WireFault),
    ):
        bus.transact(read_registers(1, 3, 7, 1))


def test_an_exception_is_raised() -> None:
    with bus_to(lambda i, data: frame(1, 1, b"\x83\x02")) as bus, pytest.raises(DeviceRefused, match="exception 2"):
        bus.transact(read_registers(1, 3, 7, 1))


def test_a_stream_that_is_not_modbus_tcp_is_refused() -> None:
    with (
        bus_to(lambda i, data: b"HTTP/1.1 400 Bad Request") as bus,
        pytest.raises(PortFault, match="does not speak Modbus TCP"),
    ):
        bus.transact(read_registers(1, 3, 7, 1))


def test_what_is_not_modbus_tcp_is_refused_on_the_connection_after_a_silent_one() -> None:
    with bus_to(lambda i, _: b"HTTP/1.1 400" if i else b"", timeout_s=0.05, connections=2) as bus:
        for words in ("no answer within", "out of step"):
            with pytest.raises(WireFault, match=words):
                bus.transact(read_registers(1, 3, 7, 1))
        with pytest.raises(PortFault, match="does not speak Modbus TCP"):
            bus.transact(read_registers(1, 3, 7, 1))
