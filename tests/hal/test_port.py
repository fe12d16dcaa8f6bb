from __future__ import annotations

import re

import pytest

from hal.errors import BadInput
from hal.port import PortName, list_serial_ports, parse_port


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("/dev/ttyUSB0", PortName("serial", "/dev/ttyUSB0")),
        ("COM3", PortName("serial", "COM3")),
        ("tcp://10.0.0.7:1502", PortName("tcp", "tcp://10.0.0.7:1502", "10.0.0.7", 1502)),
        ("tcp://gateway", PortName("tcp", "tcp://gateway", "gateway", 502)),
        ("rtu+tcp://[::1]:4001", PortName("rtu+tcp", "rtu+tcp://[::1]:4001", "::1", 4001)),
    ],
)
def test_good_names(text, found) -> None:
    assert parse_port(text) == found


@pytest.mark.parametrize(
    "text", ["", " ", "http://x:1", "tcp://", "tcp://h:0", "tcp://h:99999", "tcp://h:x", "tcp://h/p"]
)
def test_bad_names_get_a_sentence(text) -> None:
    with pytest.raises(BadInput, match="port"):
        parse_port(text)


@pytest.mark.parametrize("text", ["127.0.0.1:5533", "gateway:502", "[::1]:4001"])
def test_a_host_without_its_kind_gets_told_how_it_is_written(text) -> None:
    with pytest.raises(BadInput, match=re.escape(f"a TCP port is written tcp://{text}, or rtu+tcp://{text}")):
        parse_port(text)
    assert parse_port(f"tcp://{text}").kind == "tcp"


def test_a_link_whose_name_ends_like_that_is_a_serial_port(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "usb-0:2").touch()
    assert parse_port("usb-0:2").kind == "serial"
    assert parse_port("/dev/serial/by-path/usb-0:2").kind == "serial"


def test_the_list_is_plain_values() -> None:
    for port in list_serial_ports():
        assert set(port) == {"port", "description", "serial_number", "by_id"}
        assert all(isinstance(value, str) for value in port.values())
