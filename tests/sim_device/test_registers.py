"""The register map: numbers stay whole, gaps are refused, tables mirror each other."""

from __future__ import annotations

import pytest

from sim_device.pdu import COIL, HOLDING, INPUT, Refused
from sim_device.registers import Cell, RegisterMap


class Shelf:
    """Three cells on a map, and the values behind them."""

    def __init__(self) -> None:
        self.setpoint, self.reads = 12.56, 0
        self.map = RegisterMap(
            [
                Cell("setpoint", 0, lambda: self.setpoint, self.set, lambda raw: 0.0 <= raw <= 20.0, kind="f32"),
                Cell("ticks", 2, self.count),
                Cell("input", 10, lambda: 7.0, tables=frozenset((INPUT,))),
                Cell("switch", 5, lambda: 1.0, lambda raw: None, kind="bit", tables=frozenset((COIL,))),
            ]
        )

    def set(self, raw: float) -> None:
        self.setpoint = raw

    def count(self) -> float:
        self.reads += 1
        return float(self.reads)


@pytest.fixture
def shelf() -> Shelf:
    return Shelf()


def refusal(action: object, *arguments: object) -> int:
    with pytest.raises(Refused) as caught:
        action(*arguments)  # type: ignore[operator]
    return caught.value.code


def test_one_read_covers_several_cells(shelf: Shelf) -> None:
    assert shelf.map.read(HOLDING, 0, 3) == [0x4148, 0xF5C3, 1]


def test_a_part_of_a_number_can_be_read_and_written(shelf: Shelf) -> None:
    assert shelf.map.read(HOLDING, 1, 1) == [0xF5C3]
    shelf.map.check_write(HOLDING, 1, [0])
    shelf.map.write(HOLDING, 1, [0])
    assert shelf.setpoint == 12.5


def test_gaps_and_ends_are_exception_2(shelf: Shelf) -> None:
    assert refusal(shelf.map.read, HOLDING, 2, 2) == 2
    assert refusal(shelf.map.read, HOLDING, 65535, 2) == 2
    assert refusal(shelf.map.check_write, HOLDING, 3, [0]) == 2


def test_read_only_is_exception_2_and_out_of_range_is_3(shelf: Shelf) -> None:
    assert refusal(shelf.map.check_write, HOLDING, 2, [1]) == 2
    assert refusal(shelf.map.check_write, HOLDING, 0, [0x41C8, 0x0000]) == 3  # 25.0
    assert shelf.setpoint == 12.56


def test_asking_whether_it_can_be_read_measures_nothing(shelf: Shelf) -> None:
    shelf.map.check_read(HOLDING, 0, 3)
    assert shelf.reads == 0


def test_what_function_3_reads_function_4_reads_too_but_not_coils(shelf: Shelf) -> None:
    assert shelf.map.read(INPUT, 0, 2) == shelf.map.read(HOLDING, 0, 2)
    assert shelf.map.read(HOLDING, 10, 1) == [7]
    assert shelf.map.read(COIL, 5, 1) == [1]
    assert refusal(shelf.map.read, HOLDING, 5, 1) == 2
    assert refusal(shelf.map.read, COIL, 0, 1) == 2


def test_two_numbers_in_one_register_are_named() -> None:
    with pytest.raises(ValueError, match="'b' and 'a' share register 1"):
        RegisterMap([Cell("a", 0, lambda: 0.0, kind="f32"), Cell("b", 1, lambda: 0.0)])
