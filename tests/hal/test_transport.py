from __future__ import annotations

import os
import socket
import tty

import pytest

from hal.errors import PortFault
from hal.port import parse_port
from hal.profile import Serial
from hal.transport import SerialTransport, TcpTransport, make_transport, parity_of


@pytest.fixture
def pty():
    master, slave = os.openpty()
    tty.setraw(slave)
    yield master, os.ttyname(slave)
    for fd in (master, slave):
        os.close(fd)


def test_bytes_pass_as_they_are_in_both_directions(pty) -> None:
    master, name = pty
    line = SerialTransport(name, Serial())
    line.open()
    every = bytes(range(256))
    line.write(every)
    assert os.read(master, 300) == every
    os.write(master, every)
    assert line.read(1.0) == every
    assert line.read(0.0) == b""
    line.close()
    line.close()


@pytest.mark.parametrize("parity", ["N", "E", "O"])
@pytest.mark.parametrize("stop_bits", [1, 2])
def test_a_profile_with_parity_can_be_tried_on_a_pseudo_terminal(pty, parity, stop_bits) -> None:
    master, name = pty
    line = SerialTransport(name, Serial(parity=parity, stop_bits=stop_bits))
    line.open()
    line.write(b"\xff")
    assert os.read(master, 9) == b"\xff"
    line.close()


def test_parity_is_kept_on_everything_else() -> None:
    assert parity_of(os.devnull, Serial(parity="E")) == "E"
    assert parity_of("/dev/absent", Serial(parity="O")) == "O"


def test_a_port_belongs_to_one_program(pty) -> None:
    _, name = pty
    one, two = SerialTransport(name, Serial()), SerialTransport(name, Serial())
    one.open()
    with pytest.raises(PortFault, match="is busy"):
        two.open()
    one.close()
    two.open()
    two.close()


def test_a_connection_that_the_other_end_closes_is_gone() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
        line = make_transport(parse_port(f"rtu+tcp://127.0.0.1:{number}"), Serial())
        assert isinstance(line, TcpTransport)
        line.open()
        peer, _ = server.accept()
        peer.sendall(b"\x01\x02")
        assert line.read(1.0) == b"\x01\x02"
        peer.close()
        with pytest.raises(PortFault, match="is gone"):
            line.read(1.0)
        line.close()


def test_nobody_listens() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
    with pytest.raises(PortFault, match=r"cannot be reached \(Connection refused\)"):
        TcpTransport(parse_port(f"tcp://127.0.0.1:{number}")).open()
