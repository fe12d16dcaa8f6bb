"""When an RTU line sleeps and when it looks: in virtual time, with a wire that delivers byte by byte."""

from __future__ import annotations

import pytest

from hal.clock import SteppedClock
from hal.errors import WireFault
from hal.framing import seal
from hal.line import RtuLine
from hal.pdu import read_registers
from hal.profile import Serial

SERIAL = Serial(baud=9600)  # a character takes 1.04 ms, t3.5 is 3.65 ms
REPLY = seal(1, bytes.fromhex("03 04 12 34 56 78"))
REFUSAL = seal(1, bytes.fromhex("83 02"))


class Looking(SteppedClock):
    """Virtual time in which a look at the clock costs a microsecond."""

    def now_s(self) -> float:
        self.sleep_until(super().now_s() + 1e-6)
        return super().now_s()


class SlowWire:
    """Every byte of `reply` becomes readable at its own time; who sleeps over one is `late_s` late."""

    late_s = 0.0001

    def __init__(self, clock: SteppedClock, reply: bytes) -> None:
        self._clock = clock
        self._reply = reply
        self._due: list[tuple[float, int]] = []
        self.slept = 0

    def open(self) -> None: ...

    def close(self) -> None: ...

    def write(self, data: bytes) -> None:
        start_s = self._clock.now_s() + len(data) * SERIAL.char_s + SERIAL.silence_s
        self._due = [(start_s + (k + 1) * SERIAL.char_s, byte) for k, byte in enumerate(self._reply)]

    def read(self, timeout_s: float) -> bytes:
        now_s = self._clock.now_s()
        if timeout_s > 0.0:
            self.slept += 1
            until_s = now_s + timeout_s
            if self._due and self._due[0][0] > now_s:
                until_s = min(until_s, self._due[0][0] + self.late_s)
            self._clock.sleep_until(until_s if not self._due or self._due[0][0] > now_s else now_s)
            now_s = self._clock.now_s()
        arrived = bytes(byte for due_s, byte in self._due if due_s <= now_s)
        self._due = self._due[len(arrived) :]
        return arrived


def ask(reply: bytes) -> tuple[float, SlowWire, bytes]:
    """(how late the answer was taken [s], the wire, the answer's PDU)."""
    clock = Looking()
    wire = SlowWire(clock, reply)
    line = RtuLine(wire, SERIAL, clock, wire=clock)
    line.open()
    answer = line.ask(read_registers(1, 3, 0, 2), 1.0)
    ideal_s = (8 + len(reply)) * SERIAL.char_s + SERIAL.silence_s
    return answer.latency_s - ideal_s, wire, answer.pdu


@pytest.mark.parametrize("reply", [REPLY, REFUSAL], ids=["answer", "refusal"])
def test_the_last_byte_is_watched_for_and_not_slept_over(reply: bytes) -> None:
    late_s, wire, pdu = ask(reply)
    assert pdu == reply[1:-2]
    assert late_s < 0.00003
    assert wire.slept == len(reply) - 1, "every byte but the last is waited for asleep"


def test_an_answer_that_is_cut_is_waited_for_until_the_timeout_and_no_longer() -> None:
    clock = Looking()
    wire = SlowWire(clock, REPLY[:-1])
    line = RtuLine(wire, SERIAL, clock, wire=clock)
    line.open()
    with pytest.raises(WireFault, match="only 8 of 9 bytes"):
        line.ask(read_registers(1, 3, 0, 2), 1.0)
    assert clock.now_s() == pytest.approx(1.0 + SERIAL.silence_s, abs=0.002)
