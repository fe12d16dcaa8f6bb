"""A search on a real pseudo-terminal."""

from __future__ import annotations

import math

import pytest

from hal.clock import SteppedClock
from hal.errors import PortFault
from hal.framing import seal
from hal.port import parse_port
from hal.probe import probe, settings_to_try


def test_units_that_answer_are_found_and_the_others_are_not(slave) -> None:
    right = slave.reply
    slave.reply = lambda f: right(f) if f[0] == 2 else seal(3, b"\x83\x02") if f[0] == 3 else b""
    found = list(probe(parse_port(slave.port), settings_to_try([9600], ["N"]), range(1, 5), timeout_s=0.02, rounds=3))
    assert [(f.unit, f.baud, f.answer) for f in found] == [(2, 9600, "register 0 read"), (3, 9600, "exception 2")]
    assert all(math.isnan(f.turnaround_ms) and math.isnan(f.worst_ms) for f in found), "a pseudo-terminal has no bits"
    assert all(f[1] == 3 for f in slave.requests), "a search must not write"


def test_the_turnaround_is_what_an_answer_takes_beyond_its_bytes(slave) -> None:
    right, clock, thinks_ms = slave.reply, SteppedClock(), iter((9.0, 20.0, 50.0, 30.0))

    def slow(frame: bytes) -> bytes:
        clock.sleep_until(clock.now_s() + 1e-3 * next(thinks_ms))
        return right(frame)

    slave.reply = slow
    settings = settings_to_try([9600], ["N"])
    (found,) = probe(parse_port(slave.port), settings, [2], timeout_s=2.0, rounds=3, clock=clock)
    wire_ms = 1e3 * (8 + 7) * settings[0].char_s
    assert found.turnaround_ms == pytest.approx(30.0 - wire_ms), "the first answer is left out"
    assert found.worst_ms == pytest.approx(50.0 - wire_ms)


def test_a_port_that_is_not_there() -> None:
    with pytest.raises(PortFault, match="there is no port"):
        list(probe(parse_port("/dev/ttyNOPE"), settings_to_try([9600], ["N"]), [1]))
