"""Bytes that take their time."""

from __future__ import annotations

import pytest

from hal.clock import SteppedClock
from sim_device.pacing import Pace, emit


class SteadyClock:
    """A clock that moves by one step whenever somebody looks."""

    def __init__(self, step_s: float) -> None:
        self._now_s, self._step_s = 0.0, step_s

    def now_s(self) -> float:
        self._now_s += self._step_s
        return self._now_s

    def sleep_until(self, time_s: float) -> None:
        self._now_s = max(self._now_s, time_s)


class LateClock(SteppedClock):
    """Wakes up `late_s` after it was told to."""

    def __init__(self, late_s: float) -> None:
        super().__init__(0.0)
        self._late_s = late_s

    def sleep_until(self, time_s: float) -> None:
        if time_s > self.now_s():
            super().sleep_until(time_s + self._late_s)


def test_characters_take_start_data_parity_and_stop_bits() -> None:
    assert Pace(9600).char_s == pytest.approx(1.0417e-3, rel=1e-4)
    assert Pace(9600, 11).char_s == pytest.approx(1.1458e-3, rel=1e-4)


def test_a_reply_waits_for_the_request_to_cross_the_wire_and_for_the_silence_behind_it() -> None:
    assert Pace(9600).reply_starts_s(1.0, 8) == pytest.approx(1.0 + 8 * 1.0417e-3 + 3.646e-3, rel=1e-5)
    assert Pace(115200).reply_starts_s(1.0, 8) == pytest.approx(1.0 + 8 * 86.8e-6 + 1.75e-3, rel=1e-5)
    assert Pace(9600, turnaround_s=0.0).reply_starts_s(1.0, 0) == 1.0


def test_every_byte_arrives_when_its_last_bit_has_crossed_the_wire() -> None:
    clock, arrived = SteppedClock(0.0), []
    emit(b"abcd", 2.0, Pace(9600), clock, lambda piece: arrived.append((clock.now_s(), piece)))
    assert b"".join(piece for _, piece in arrived) == b"abcd"
    assert [time_s for time_s, _ in arrived] == pytest.approx([2.0 + k * 10 / 9600 for k in (1, 2, 3, 4)])


def test_the_last_byte_is_waited_for_with_open_eyes() -> None:
    clock, arrived = SteadyClock(1e-6), []
    emit(b"ab", 0.0, Pace(9600), clock, lambda piece: arrived.append((clock.now_s(), piece)), early_s=150e-6)
    assert [piece for _, piece in arrived] == [b"a", b"b"]
    assert 2 * 10 / 9600 <= arrived[-1][0] < 2 * 10 / 9600 + 5e-6


def test_a_late_wake_up_delays_no_later_byte() -> None:
    clock, arrived = LateClock(2.5e-3), []
    data = bytes(range(20))
    emit(data, 0.0, Pace(9600), clock, lambda piece: arrived.append((clock.now_s(), piece)))
    assert b"".join(piece for _, piece in arrived) == data
    assert arrived[-1][0] <= 20 * 10 / 9600 + 2.5e-3 + 1e-9
    assert len(arrived) < 10
