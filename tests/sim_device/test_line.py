"""Who answers on a line, and who keeps silent."""

from __future__ import annotations

import pytest

from sim_device.crc import sealed
from sim_device.diagnostics import Diagnostics
from sim_device.identity import Identity
from sim_device.line import Line, Unit
from sim_device.pdu import Server
from sim_device.registers import Cell, RegisterMap


class Neighbour:
    """One register at 0 that can be written, and a count of how often it was spoken to."""

    def __init__(self, value: float) -> None:
        self.value, self.heard = value, 0
        cells = [Cell("value", 0, lambda: self.value, self.set)]
        diagnostics = Diagnostics()
        self.unit = Unit(Server(RegisterMap(cells), diagnostics, Identity({})), diagnostics, self.hear)

    def set(self, raw: float) -> None:
        self.value = raw

    def hear(self) -> None:
        self.heard += 1


@pytest.fixture
def pair() -> tuple[Neighbour, Neighbour]:
    return Neighbour(5.0), Neighbour(6.0)


@pytest.fixture
def line(pair: tuple[Neighbour, Neighbour]) -> Line:
    return Line({5: pair[0].unit, 6: pair[1].unit})


def test_only_the_addressed_unit_answers_and_hears(line: Line, pair: tuple[Neighbour, Neighbour]) -> None:
    assert line.rtu(sealed(bytes.fromhex("06 03 00 00 00 01"))) == sealed(bytes.fromhex("06 03 02 00 06"))
    assert line.rtu(sealed(bytes.fromhex("07 03 00 00 00 01"))) is None
    assert (pair[0].heard, pair[1].heard) == (0, 1)


def test_a_broadcast_write_reaches_all_and_nobody_answers(line: Line, pair: tuple[Neighbour, Neighbour]) -> None:
    assert line.rtu(sealed(bytes.fromhex("00 06 00 00 00 09"))) is None
    assert (pair[0].value, pair[1].value) == (9.0, 9.0)


@pytest.mark.parametrize("body", ["00 03 00 00 00 01", "00 17 00 00 00 01 00 00 00 01 02 00 07", "00 08 00 0a 00 00"])
def test_a_broadcast_that_is_no_write_is_ignored(line: Line, pair: tuple[Neighbour, Neighbour], body: str) -> None:
    assert line.rtu(sealed(bytes.fromhex(body))) is None
    assert (pair[0].value, pair[0].heard) == (5.0, 0)


def test_modbus_tcp_may_leave_out_the_unit_id(line: Line) -> None:
    read = bytes.fromhex("03 00 00 00 01")
    assert line.tcp(255, read) == line.tcp(0, read) == line.tcp(5, read) == bytes.fromhex("03 02 00 05")
    assert line.tcp(7, read) is None
