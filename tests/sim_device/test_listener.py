"""The same device over sockets."""

from __future__ import annotations

import contextlib
import socket
import struct

import pytest

from hal.errors import BadInput, PortFault
from sim_device.crc import sealed
from sim_device.listener import parse_address


def connect(url: str) -> socket.socket:
    host, _, port = url.rpartition("//")[2].rpartition(":")
    return socket.create_connection((host, int(port)), timeout=2.0)


def ask(line: socket.socket, request_hex: str, unit: int = 1, transaction: int = 7) -> str:
    pdu = bytes.fromhex(request_hex)
    line.sendall(struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu)
    head = line.recv(7, socket.MSG_WAITALL)
    echoed, protocol, length, answered_by = struct.unpack(">HHHB", head)
    assert (echoed, protocol, answered_by) == (transaction, 0, unit)
    return line.recv(length - 1, socket.MSG_WAITALL).hex(" ")


def test_modbus_tcp_with_the_header_of_the_specification(start) -> None:  # type: ignore[no-untyped-def]
    device = start(tcp="127.0.0.1:0")
    assert device.port.startswith("tcp://127.0.0.1:")
    with connect(device.port) as line:
        assert ask(line, "10 00 00 00 02 04 40 e8 00 00") == "10 00 00 00 02"
        assert ask(line, "03 00 10 00 02", unit=255) == "03 04 40 e8 00 00"
        assert ask(line, "03 00 40 00 01") == "83 02"


def test_two_masters_at_once_and_silence_for_other_units(start) -> None:  # type: ignore[no-untyped-def]
    device = start(tcp="tcp://127.0.0.1:0")
    with connect(device.port) as one, connect(device.port) as two:
        two.sendall(struct.pack(">HHHB", 1, 0, 6, 9) + bytes.fromhex("03 00 10 00 02"))
        assert ask(one, "06 00 20 00 14") == "06 00 20 00 14"
        assert ask(two, "03 00 20 00 01", transaction=2) == "03 02 00 14"


def test_what_is_not_modbus_is_hung_up_on(start) -> None:  # type: ignore[no-untyped-def]
    device = start(tcp="127.0.0.1:0")
    with connect(device.port) as line:
        line.sendall(b"GET / HTTP/1.1\r\n\r\n")
        with contextlib.suppress(ConnectionResetError):  # unread bytes turn the hang-up into a reset
            assert line.recv(1) == b""
    with connect(device.port) as line:
        assert ask(line, "03 00 10 00 02") == "03 04 00 00 00 00"


def test_rtu_frames_over_tcp(start) -> None:  # type: ignore[no-untyped-def]
    device = start(tcp="rtu+tcp://127.0.0.1:0")
    assert device.port.startswith("rtu+tcp://")
    with connect(device.port) as line:
        line.sendall(sealed(bytes.fromhex("01 03 00 10 00 02")))
        assert line.recv(9, socket.MSG_WAITALL) == sealed(bytes.fromhex("01 03 04 00 00 00 00"))


def test_a_terminal_and_a_socket_at_once(start, tmp_path) -> None:  # type: ignore[no-untyped-def]
    device = start(tcp="127.0.0.1:0", link=tmp_path / "valve")
    assert device.port == str(tmp_path / "valve")
    with connect(device.tcp_url) as line:
        assert ask(line, "03 00 10 00 02") == "03 04 00 00 00 00"


@pytest.mark.parametrize("text", ["127.0.0.1", ":5020", "host:", "host:http", "127.0.0.1:70000"])
def test_addresses_that_cannot_be(text: str) -> None:
    with pytest.raises(BadInput, match="HOST:PORT"):
        parse_address(text)


def test_addresses_that_can() -> None:
    assert parse_address("rtu+tcp://127.0.0.1:5020") == ("rtu+tcp://", "127.0.0.1", 5020)
    assert parse_address("tcp://[::1]:0") == ("tcp://", "::1", 0)


def test_loopback_only_and_a_taken_port_is_named(start) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match="loopback"):
        start(tcp="0.0.0.0:0")
    taken = start(tcp="127.0.0.1:0").port.rpartition(":")[2]
    with pytest.raises(PortFault, match=f"127.0.0.1:{taken}"):
        start(tcp=f"127.0.0.1:{taken}")
