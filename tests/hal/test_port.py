from __future__ import annotations

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


def test_the_list_is_plain_values() -> None:
    for port in list_serial_ports():
        assert set(port) == {"port", "description", "serial_number", "by_id"}
        assert all(isinstance(value, str) for value in port.values())
