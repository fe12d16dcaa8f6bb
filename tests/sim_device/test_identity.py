"""What function 43/14 says of the device."""

from __future__ import annotations

from sim_device.identity import Identity

FULL = Identity({0: "Maker", 1: "Code", 2: "1.0", 4: "Valve", 5: "Model", 0x80: "private"})


def numbers(reply: bytes | None) -> list[int]:
    """The object numbers in a reply."""
    assert reply is not None
    found, at = [], 4
    while at < len(reply):
        found.append(reply[at])
        at += 2 + reply[at + 1]
    assert reply[3] == len(found)
    return found


def test_each_category_includes_the_one_before() -> None:
    assert numbers(FULL.reply(1, 0)) == [0, 1, 2]
    assert numbers(FULL.reply(2, 0)) == [0, 1, 2, 4, 5]
    assert numbers(FULL.reply(3, 0)) == [0, 1, 2, 4, 5, 0x80]


def test_a_stream_starts_where_it_is_told_or_at_the_beginning_when_that_is_not_there() -> None:
    assert numbers(FULL.reply(2, 4)) == [4, 5]
    assert numbers(FULL.reply(2, 3)) == [0, 1, 2, 4, 5]


def test_one_object_alone() -> None:
    assert FULL.reply(4, 5) == bytes((0x82, 0, 0, 1, 5, 5)) + b"Model"
    assert FULL.reply(4, 3) is None
    assert FULL.reply(5, 0) is None


def test_letters_that_modbus_does_not_have_are_replaced() -> None:
    assert Identity({0: "Zürich"}).reply(4, 0) == bytes((0x82, 0, 0, 1, 0, 6)) + b"Z?rich"
