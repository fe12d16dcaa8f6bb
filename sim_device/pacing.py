"""A pseudo-terminal has no baud rate: this gives it one, so that the limit of the wire is real."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from dataclasses import dataclass

from hal.clock import Clock
from sim_device.framer import rtu_idle_s

_PR_SET_TIMERSLACK = 29  # from linux/prctl.h; the value is in nanoseconds


@dataclass(frozen=True)
class Pace:
    """How long bytes take on a line of `baud`, with `bits_per_char` (10 for 8N1, 11 for 8E1 and 8N2)."""

    baud: int
    bits_per_char: int = 10
    turnaround_s: float | None = None  # None: one t3.5, the shortest silence that ends a request

    @property
    def char_s(self) -> float:
        return self.bits_per_char / self.baud

    @property
    def silence_s(self) -> float:
        """One t3.5 [s]: what ends a frame."""
        return rtu_idle_s(self.baud, self.bits_per_char)

    def reply_starts_s(self, request_arrived_s: float, request_bytes: int) -> float:
        """When a slave may start to answer: the request has crossed the wire, and the line was silent after it."""
        silence_s = self.silence_s if self.turnaround_s is None else self.turnaround_s
        return request_arrived_s + request_bytes * self.char_s + silence_s


def sharpen_timer() -> None:
    """Asks Linux to wake this thread when it said, not up to 50 us later; elsewhere, does nothing."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0)


def emit(
    data: bytes,
    start_s: float,
    pace: Pace,
    clock: Clock,
    write: Callable[[bytes], None],
    early_s: float = 0.0,
) -> None:
    """Writes byte k of `data` when its last bit would have crossed the wire: `start_s` + (k + 1) characters.

    Deadlines are absolute, so a late wake-up delays no later byte. For the last byte, which ends the frame, it wakes
    `early_s` before and watches the clock: a UART is not late either. That needs a clock that runs.
    """
    sent = 0
    while sent < len(data):
        due_s = start_s + (sent + 1) * pace.char_s
        last = sent == len(data) - 1
        clock.sleep_until(due_s - early_s if last else due_s)
        while last and early_s and clock.now_s() < due_s:
            pass
        due = int((clock.now_s() - start_s) / pace.char_s + 1e-9)
        due = max(sent + 1, min(due, len(data)))
        write(data[sent:due])
        sent = due
