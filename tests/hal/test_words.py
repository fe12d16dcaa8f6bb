from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.words import RANGE, decode, encode

ORDERS = ("ABCD", "CDAB", "BADC", "DCBA")


@pytest.mark.parametrize(
    ("order", "words"),
    # 123456.0 is 47 F1 20 00 in IEEE 754
    [("ABCD", (0x47F1, 0x2000)), ("CDAB", (0x2000, 0x47F1)), ("BADC", (0xF147, 0x0020)), ("DCBA", (0x0020, 0xF147))],
)
def test_a_float_in_every_word_order(order, words) -> None:
    assert encode(123456.0, "f32", order) == words
    assert decode(words, "f32", order) == 123456.0


def test_signed_and_unsigned() -> None:
    assert decode((0xFFFF,), "u16") == 65535
    assert decode((0xFFFF,), "i16") == -1
    assert decode((0xFFFF, 0xFFFE), "i32") == -2
    assert decode((0x0001, 0x0000), "u32", "CDAB") == 1


def test_byte_order_matters_for_one_word_and_word_order_does_not() -> None:
    assert decode((0x1234,), "u16", "CDAB") == 0x1234
    assert decode((0x1234,), "u16", "BADC") == decode((0x1234,), "u16", "DCBA") == 0x3412


@given(st.integers(-(2**31), 2**31 - 1), st.sampled_from(ORDERS))
def test_integers_survive_the_round_trip(value, order) -> None:
    assert decode(encode(value, "i32", order), "i32", order) == value


@given(st.floats(width=32), st.sampled_from(ORDERS))
def test_floats_survive_the_round_trip(value, order) -> None:
    back = decode(encode(value, "f32", order), "f32", order)
    assert back == value or (math.isnan(back) and math.isnan(value))


@pytest.mark.parametrize("kind", ["u16", "i16", "u32", "i32"])
def test_what_does_not_fit_is_refused_and_the_ends_fit(kind) -> None:
    low, high = RANGE[kind]
    assert decode(encode(low, kind), kind) == low
    assert decode(encode(high, kind), kind) == high
    for beyond in (low - 1, high + 1):
        with pytest.raises(ValueError, match=f"does not fit into {kind}"):
            encode(beyond, kind)


def test_integers_are_rounded_to_the_nearest() -> None:
    assert encode(1.6, "u16") == (2,)
    assert encode(-1.6, "i16") == (0xFFFE,)
