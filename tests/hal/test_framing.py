"""Frames: check values, literal frames, and what must never be taken for an answer."""

from __future__ import annotations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hal.framing import crc16, describe, find_reply, seal
from hal.pdu import identify, read_registers, write_and_read, write_register, write_registers


def test_check_values_of_the_checksum() -> None:
    assert crc16(b"123456789") == 0x4B37
    assert crc16(bytes.fromhex("02 07")) == 0x1241  # Modbus over serial line V1.02, appendix B


@pytest.mark.parametrize(
    ("unit", "pdu", "frame"),
    [
        (0x11, "03 00 6B 00 03", "11 03 00 6B 00 03 76 87"),
        (0x01, "03 00 00 00 0A", "01 03 00 00 00 0A C5 CD"),
        (0x11, "06 00 01 00 03", "11 06 00 01 00 03 9A 9B"),
        (0x11, "10 00 01 00 02 04 00 0A 01 02", "11 10 00 01 00 02 04 00 0A 01 02 C6 F0"),
        (0x0A, "81 02", "0A 81 02 B0 53"),
    ],
)
def test_literal_frames(unit, pdu, frame) -> None:
    assert seal(unit, bytes.fromhex(pdu)) == bytes.fromhex(frame)
    assert crc16(bytes.fromhex(frame)) == 0


READ = read_registers(0x11, 3, 0x6B, 3)
ANSWER = bytes.fromhex("11 03 06 AE 41 56 52 43 40 49 AD")


def test_an_answer_alone_and_among_noise() -> None:
    assert find_reply(ANSWER, READ) == (0, 11)
    assert find_reply(b"\x11\x03\x06" + ANSWER + b"\x00", READ) == (3, 14)


def test_an_exception_is_found_and_only_to_our_function() -> None:
    assert find_reply(seal(0x11, b"\x83\x02"), READ) == (0, 5)
    assert find_reply(seal(0x11, b"\x84\x02"), READ) is None
    assert find_reply(seal(0x12, b"\x83\x02"), READ) is None
    assert find_reply(seal(0x11, b"\x83\x40"), READ) is None


def test_an_answer_of_unknown_length() -> None:
    frame = seal(1, bytes.fromhex("2B 0E 01 01 00 00 01 00 02 41 42"))
    assert find_reply(b"\x99" + frame, identify(1)) == (1, 1 + len(frame))
    assert find_reply(frame[:-1], identify(1)) is None


WORDS = st.lists(st.integers(0, 65535), min_size=1, max_size=8)
REQUESTS = st.one_of(
    st.builds(read_registers, st.just(1), st.sampled_from((3, 4)), st.integers(0, 60000), st.integers(1, 20)),
    st.builds(write_register, st.just(1), st.integers(0, 60000), st.integers(0, 65535)),
    st.builds(write_registers, st.just(1), st.integers(0, 60000), WORDS),
    st.builds(
        write_and_read,
        st.just(1),
        st.integers(0, 60000),
        WORDS,
        st.integers(0, 60000),
        st.integers(1, 12),
    ),
)


@st.composite
def exchanges(draw):
    """A request and one right answer to it, as a frame."""
    request = draw(REQUESTS)
    body = draw(st.binary(min_size=request.size - len(request.head), max_size=request.size - len(request.head)))
    return request, seal(1, request.head + body)


@given(exchanges(), st.binary(max_size=40), st.binary(max_size=6))
def test_noise_around_an_answer_never_hides_it(exchange, before, after) -> None:
    request, frame = exchange
    found = find_reply(before + frame + after, request)
    assert found is not None
    # Noise may by chance hold an intact frame of its own; then that comes first, and it is intact.
    start, end = found
    assert crc16((before + frame + after)[start:end]) == 0


@given(exchanges(), st.data())
def test_up_to_three_flipped_bits_never_make_another_answer(exchange, data) -> None:
    request, frame = exchange
    bits = data.draw(st.sets(st.integers(0, 8 * len(frame) - 1), min_size=1, max_size=3))
    spoilt = bytearray(frame)
    for bit in bits:
        spoilt[bit // 8] ^= 1 << bit % 8
    assert find_reply(bytes(spoilt), request) is None


@given(exchanges(), st.data())
def test_a_burst_of_up_to_sixteen_bits_never_makes_another_answer(exchange, data) -> None:
    request, frame = exchange
    pattern = data.draw(st.integers(1, 0xFFFF))
    shift = data.draw(st.integers(0, 8 * len(frame) - 16))
    number = int.from_bytes(frame, "little") ^ (pattern << shift)
    assert find_reply(number.to_bytes(len(frame), "little"), request) is None


@given(exchanges(), st.integers(1, 200))
def test_a_truncated_answer_is_none(exchange, cut) -> None:
    request, frame = exchange
    assert find_reply(frame[: max(0, len(frame) - cut)], request) is None


@given(exchanges(), exchanges())
def test_the_answer_to_another_request_is_taken_only_if_it_has_the_very_same_shape(one, other) -> None:
    (request, _), (stranger, frame) = one, other
    assume(request.head != stranger.head or request.size != stranger.size)
    assert find_reply(frame, request) is None


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "no answer"),
        (ANSWER[:6], "only 6 of 11 bytes"),
        (ANSWER[:-1] + b"\x00", "wrong checksum"),
        (seal(0x12, b"\x03\x02\x00\x01"), "an answer from unit 18 instead of unit 17"),
        (seal(0x11, b"\x04\x02\x00\x01"), "an intact answer to something else"),
        (b"\xf0\x0f\x00", "3 bytes of garbage"),
    ],
)
def test_what_came_instead_is_named(data, said) -> None:
    assert said in describe(data, READ)
