"""Literal PDUs of the examples in the Modbus Application Protocol V1.1b3, section 6."""

from __future__ import annotations

import pytest

from hal import pdu

CASES = {
    "1 read coils": (pdu.read_coils(1, 0x13, 19), "01 00 13 00 13", "01 03 CD 6B 05"),
    "3 read holding": (pdu.read_registers(1, 3, 0x6B, 3), "03 00 6B 00 03", "03 06 02 2B 00 00 00 64"),
    "4 read input": (pdu.read_registers(1, 4, 8, 1), "04 00 08 00 01", "04 02 00 0A"),
    "5 write coil": (pdu.write_coil(1, 0xAC, True), "05 00 AC FF 00", "05 00 AC FF 00"),
    "6 write one": (pdu.write_register(1, 1, 3), "06 00 01 00 03", "06 00 01 00 03"),
    "8 echo": (pdu.echo(1, 0xA537), "08 00 00 A5 37", "08 00 00 A5 37"),
    "16 write many": (pdu.write_registers(1, 1, (10, 0x102)), "10 00 01 00 02 04 00 0A 01 02", "10 00 01 00 02"),
    "23 write and read": (
        pdu.write_and_read(1, 14, (0xFF, 0xFF, 0xFF), 3, 6),
        "17 00 03 00 06 00 0E 00 03 06 00 FF 00 FF 00 FF",
        "17 0C 00 FE 0A CD 00 01 00 03 00 0D 00 FF",
    ),
    "43/14 identify": (
        pdu.identify(1),
        "2B 0E 01 00",
        "2B 0E 01 01 00 00 03 00 16" + b"Company identification".hex()
        + "01 0F" + b"Product code XX".hex() + "02 05" + b"V2.11".hex(),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_requests_are_those_of_the_specification(name) -> None:
    request, literal, _ = CASES[name]
    assert request.pdu == bytes.fromhex(literal)


@pytest.mark.parametrize("name", CASES)
def test_the_answer_of_the_specification_is_accepted_and_no_other(name) -> None:
    request, _, literal = CASES[name]
    answer = bytes.fromhex(literal)
    assert request.accepts(answer)
    assert not request.accepts(answer + b"\x00")
    assert not request.accepts(answer[:-1])
    assert not request.accepts(bytes((answer[0] ^ 4,)) + answer[1:])


@pytest.mark.parametrize("name", CASES)
def test_every_function_may_be_refused_with_a_known_code_only(name) -> None:
    request = CASES[name][0]
    assert request.accepts(bytes((request.function | 0x80, 2)))
    assert not request.accepts(bytes((request.function | 0x80, 99)))
    assert not request.accepts(bytes((request.function | 0x80, 2, 0)))


def test_other_addresses_and_counts_are_not_the_answer() -> None:
    assert not pdu.write_registers(1, 1, (10, 11)).accepts(bytes.fromhex("10 00 02 00 02"))
    assert not pdu.write_registers(1, 1, (10, 11)).accepts(bytes.fromhex("10 00 01 00 01"))
    assert not pdu.write_register(1, 1, 3).accepts(bytes.fromhex("06 00 01 00 04"))
    assert not pdu.echo(1, 7).accepts(bytes.fromhex("08 00 00 00 08"))


def test_words_and_objects_are_taken_out() -> None:
    assert pdu.words_of(bytes.fromhex(CASES["3 read holding"][2])) == (0x22B, 0, 100)
    found, more = pdu.objects_of(bytes.fromhex(CASES["43/14 identify"][2]))
    assert found == {0: "Company identification", 1: "Product code XX", 2: "V2.11"}
    assert more is None
    _, more = pdu.objects_of(bytes.fromhex("2B 0E 01 01 FF 02 01 00 01 41"))
    assert more == 2
