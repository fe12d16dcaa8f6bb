"""Functions and exceptions, against the examples of the Modbus Application Protocol V1.1b3, section 6."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from sim_device.diagnostics import Diagnostics
from sim_device.identity import Identity
from sim_device.pdu import COIL, HOLDING, INPUT, Refused, Server


class Memory:
    """Registers and coils 0..255 that hold what they are given; 200 and above cannot be written."""

    def __init__(self) -> None:
        self.tables = {table: [0] * 256 for table in (COIL, HOLDING, INPUT)}

    def check_read(self, table: int, address: int, count: int) -> None:
        if address + count > 256:
            raise Refused(2)

    def read(self, table: int, address: int, count: int) -> Sequence[int]:
        self.check_read(table, address, count)
        return self.tables[table][address : address + count]

    def check_write(self, table: int, address: int, values: Sequence[int]) -> None:
        if address + len(values) > 200:
            raise Refused(2)
        if table == HOLDING and 0xDEAD in values:
            raise Refused(3)

    def write(self, table: int, address: int, values: Sequence[int]) -> None:
        self.tables[table][address : address + len(values)] = values


@pytest.fixture
def memory() -> Memory:
    memory = Memory()
    memory.tables[HOLDING][107:110] = [0x022B, 0x0000, 0x0064]
    memory.tables[HOLDING][3:9] = [0x00FE, 0x0ACD, 0x0001, 0x0003, 0x000D, 0x00FF]
    memory.tables[INPUT][8] = 0x000A
    memory.tables[COIL][19:38] = [int(bit) for byte in (0xCD, 0x6B, 0x05) for bit in f"{byte:08b}"[::-1]][:19]
    return memory


@pytest.fixture
def server(memory: Memory) -> Server:
    return Server(memory, Diagnostics(), Identity({0: "Maker", 1: "Code", 2: "V2.11", 5: "Model"}))


@pytest.mark.parametrize(
    ("request_hex", "reply_hex"),
    [
        ("01 00 13 00 13", "01 03 cd 6b 05"),
        ("03 00 6b 00 03", "03 06 02 2b 00 00 00 64"),
        ("04 00 08 00 01", "04 02 00 0a"),
        ("05 00 ac ff 00", "05 00 ac ff 00"),
        ("06 00 01 00 03", "06 00 01 00 03"),
        ("08 00 00 a5 37", "08 00 00 a5 37"),
        ("0f 00 13 00 0a 02 cd 01", "0f 00 13 00 0a"),
        ("10 00 01 00 02 04 00 0a 01 02", "10 00 01 00 02"),
        ("17 00 03 00 06 00 0e 00 03 06 00 ff 00 ff 00 ff", "17 0c 00 fe 0a cd 00 01 00 03 00 0d 00 ff"),
    ],
)
def test_the_examples_of_the_specification(server: Server, request_hex: str, reply_hex: str) -> None:
    assert server.answer(bytes.fromhex(request_hex)).hex(" ") == reply_hex


def test_mask_write_as_in_the_specification(server: Server, memory: Memory) -> None:
    memory.tables[HOLDING][4] = 0x12
    request = bytes.fromhex("16 00 04 00 f2 00 25")
    assert server.answer(request) == request
    assert memory.tables[HOLDING][4] == 0x17


def test_coils_and_registers_take_what_is_written(server: Server, memory: Memory) -> None:
    server.answer(bytes.fromhex("0f 00 13 00 0a 02 cd 01"))
    assert memory.tables[COIL][19:29] == [1, 0, 1, 1, 0, 0, 1, 1, 1, 0]
    server.answer(bytes.fromhex("10 00 01 00 02 04 00 0a 01 02"))
    assert memory.tables[HOLDING][1:3] == [0x000A, 0x0102]


@pytest.mark.parametrize(
    ("request_hex", "reply_hex"),
    [
        ("63 00", "e3 01"),
        ("2b 0d 01 00", "ab 01"),
        ("08 00 03 00 00", "88 01"),
        ("03 00 ff 00 02", "83 02"),
        ("06 00 c8 00 01", "86 02"),
        ("10 00 c7 00 02 04 00 01 00 02", "90 02"),
        ("03 00 00 00 00", "83 03"),
        ("03 00 00 00 7e", "83 03"),
        ("03 00 00", "83 03"),
        ("05 00 01 12 34", "85 03"),
        ("0f 00 00 00 0a 01 ff", "8f 03"),
        ("10 00 01 00 02 02 00 0a", "90 03"),
        ("10 00 01 00 02 04 00 0a", "90 03"),
        ("06 00 01 de ad", "86 03"),
        ("17 00 00 00 7e 00 00 00 01 02 00 01", "97 03"),
        ("17 00 ff 00 02 00 00 00 01 02 00 01", "97 02"),
        ("2b 0e 05 00", "ab 03"),
        ("2b 0e 04 63", "ab 02"),
    ],
)
def test_refusals(server: Server, request_hex: str, reply_hex: str) -> None:
    assert server.answer(bytes.fromhex(request_hex)).hex(" ") == reply_hex


def test_a_read_write_that_cannot_read_has_not_written(server: Server, memory: Memory) -> None:
    assert server.answer(bytes.fromhex("17 00 ff 00 02 00 00 00 01 02 00 01")) == b"\x97\x02"
    assert memory.tables[HOLDING][0] == 0


def test_the_write_of_a_read_write_comes_first(server: Server) -> None:
    reply = server.answer(bytes.fromhex("17 00 20 00 01 00 20 00 01 02 12 34"))
    assert reply.hex(" ") == "17 02 12 34"


def test_identification_in_the_layout_of_the_specification(server: Server) -> None:
    basic = bytes.fromhex("2b 0e 01 82 00 00 03")
    assert server.answer(bytes.fromhex("2b 0e 01 00")) == basic + b"\x00\x05Maker\x01\x04Code\x02\x05V2.11"
    one = bytes.fromhex("2b 0e 04 82 00 00 01")
    assert server.answer(bytes.fromhex("2b 0e 04 05")) == one + b"\x05\x05Model"


def test_identification_that_does_not_fit_is_continued() -> None:
    texts = {number: chr(65 + number) * 100 for number in range(5)}
    server = Server(Memory(), Diagnostics(), Identity(texts))
    first = server.answer(bytes.fromhex("2b 0e 02 00"))
    assert first[4:7] == bytes((0xFF, 2, 2))
    rest = server.answer(bytes((0x2B, 0x0E, 0x02, first[5])))
    assert rest[4:7] == bytes((0xFF, 4, 2))
    assert len(first) <= 253


def test_counters_count_and_are_cleared(server: Server) -> None:
    server.answer(b"\x63")
    assert server.answer(bytes.fromhex("08 00 0d 00 00")).hex(" ") == "08 00 0d 00 01"
    assert server.answer(bytes.fromhex("08 00 0a 00 00")).hex(" ") == "08 00 0a 00 00"
    assert server.answer(bytes.fromhex("08 00 0d 00 00")).hex(" ") == "08 00 0d 00 00"
