"""Numbers in registers."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_device.codec import decode, encode, width

ORDERS = ["ABCD", "CDAB", "BADC", "DCBA"]


@pytest.mark.parametrize(
    ("order", "words"),
    [
        ("ABCD", [0x4148, 0xF5C3]),
        ("CDAB", [0xF5C3, 0x4148]),
        ("BADC", [0x4841, 0xC3F5]),
        ("DCBA", [0xC3F5, 0x4841]),
    ],
)
def test_the_four_orders_of_a_float(order: str, words: list[int]) -> None:
    assert encode(12.56, "f32", order) == words
    assert decode(words, "f32", order) == pytest.approx(12.56, rel=1e-7)


@pytest.mark.parametrize(
    ("kind", "value", "words"),
    [
        ("u16", 65535, [0xFFFF]),
        ("i16", -2, [0xFFFE]),
        ("u32", 0x12345678, [0x1234, 0x5678]),
        ("i32", -1, [0xFFFF, 0xFFFF]),
        ("u64", 2.0**40, [0, 0x100, 0, 0]),
        ("bit", 1, [1]),
    ],
)
def test_integers(kind: str, value: float, words: list[int]) -> None:
    assert encode(value, kind) == words
    assert decode(words, kind) == value
    assert width(kind) == len(words)


def test_a_converter_stops_at_its_ends() -> None:
    assert encode(70000.0, "u16") == [0xFFFF]
    assert encode(-3.0, "u16") == [0]
    assert encode(-40000.0, "i16") == [0x8000]
    assert encode(math.nan, "u16") == [0]
    assert encode(0.5000001, "u16") == [1]


@given(st.integers(-0x80000000, 0x7FFFFFFF), st.sampled_from(ORDERS))
def test_every_order_is_undone(value: int, order: str) -> None:
    assert decode(encode(value, "i32", order), "i32", order) == value
