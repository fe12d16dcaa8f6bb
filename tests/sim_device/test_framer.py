"""A slave that finds its feet: one disturbance and a silence lose no later request."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_device.crc import sealed
from sim_device.framer import RequestFramer, request_length, rtu_idle_s

READ = sealed(bytes.fromhex("01 03 00 10 00 09"))
WRITE = sealed(bytes.fromhex("01 10 00 00 00 02 04 40 e8 00 00"))
BOTH = sealed(bytes.fromhex("01 17 00 10 00 09 00 00 00 02 04 40 e8 00 00"))
ECHO = sealed(bytes.fromhex("01 08 00 00 a5 37"))
UNKNOWN = sealed(bytes.fromhex("01 63 01 02"))

DISTURBANCES = {
    "one noise byte": b"\x55",
    "truncated read": bytes.fromhex("01 03 00"),
    "truncated write that announces 246 bytes": bytes.fromhex("01 10 00 00 00 7b f6 00 01"),
    "checksum error": READ[:-1] + bytes((READ[-1] ^ 1,)),
    "20 random bytes": bytes.fromhex("9f3a01100f77c20b14e80103170417aa55f00d10"),
    "half of a read-write": BOTH[:9],
}


@pytest.mark.parametrize("noise", DISTURBANCES.values(), ids=DISTURBANCES)
def test_after_a_disturbance_and_a_silence_no_request_is_lost(noise: bytes) -> None:
    framer = RequestFramer(idle_reset_s=0.010)
    assert framer.feed(noise, 1.0) == []
    assert framer.feed(READ, 1.1) == [READ]
    assert framer.feed(BOTH, 1.2) == [BOTH]
    assert framer.discarded == len(noise)


@pytest.mark.parametrize("noise", DISTURBANCES.values(), ids=DISTURBANCES)
def test_a_request_right_behind_a_disturbance_is_found_when_the_line_falls_silent(noise: bytes) -> None:
    framer = RequestFramer(idle_reset_s=0.010)
    found = framer.feed(noise + READ, 1.0) or framer.idle(1.02)
    assert found == [READ]
    assert not framer.pending or framer.idle(1.04) == []


def test_the_silence_must_be_long_enough() -> None:
    framer = RequestFramer(idle_reset_s=0.010)
    framer.feed(READ[:4], 1.0)
    assert framer.idle(1.0099) == []
    assert framer.feed(READ[4:], 1.0099) == [READ]
    framer.feed(READ[:4], 2.0)
    assert framer.idle(2.0101) == []
    assert not framer.pending
    assert framer.damaged == 1


@pytest.mark.parametrize("frame", [READ, WRITE, BOTH, ECHO, UNKNOWN])
def test_every_split_of_a_request_gives_the_request_once(frame: bytes) -> None:
    for cut in range(1, len(frame)):
        framer = RequestFramer()
        assert framer.feed(frame[:cut], 1.0) + framer.feed(frame[cut:], 1.001) == [frame]
        assert not framer.pending


def test_two_requests_in_one_read_are_both_found() -> None:
    assert RequestFramer().feed(READ + BOTH, 1.0) == [READ, BOTH]


def test_a_long_echo_request_is_one_request() -> None:
    frame = sealed(bytes.fromhex("01 08 00 00 01 02 03 04 05 06"))
    assert RequestFramer().feed(frame, 1.0) == [frame]


def test_a_flood_without_silence_is_not_kept() -> None:
    framer = RequestFramer()
    for _ in range(100):
        framer.feed(b"\x00" * 100, 1.0)
    assert framer.discarded >= 9_700


def test_lengths_are_known_as_soon_as_they_can_be() -> None:
    assert request_length(b"\x01") is None
    assert request_length(READ[:2]) == 8
    assert request_length(WRITE[:6]) is None
    assert request_length(WRITE[:7]) == len(WRITE)
    assert request_length(BOTH[:11]) == len(BOTH)


def test_the_silence_of_the_specification() -> None:
    assert rtu_idle_s(9600) == pytest.approx(3.646e-3, rel=1e-3)
    assert rtu_idle_s(19200, 11) == pytest.approx(2.005e-3, rel=1e-3)
    assert rtu_idle_s(115200) == 1.75e-3


@given(st.binary(min_size=1, max_size=300), st.sampled_from([READ, WRITE, BOTH, ECHO]))
def test_no_noise_makes_a_slave_deaf(noise: bytes, frame: bytes) -> None:
    framer = RequestFramer(idle_reset_s=0.010)
    framer.feed(noise, 1.0)
    framer.idle(1.05)
    assert framer.feed(frame, 1.1) == [frame]
