"""Waking up on time: a thread that must not be late stays awake for the last moment, and asks for short turns.

Being woken up takes 0.05 to 0.15 ms, most of it on a machine that has nothing else to do and has gone to sleep itself.
Beside other work it takes, without short turns, until whoever runs has used up his turn: 3 ms on a usual Linux.
Source: sched_setattr(2), `sched_runtime` of SCHED_OTHER; it sets the length of a turn since Linux 6.12, and is ignored
before.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from hal.clock import Clock

EARLY_S = 0.00015  # awake so long before the moment that counts
_LOOKS = 2000  # at the clock, at most: about 0.3 ms, whatever the clock does
TURN_NS = 100_000  # the shortest that the kernel gives
_SYSCALL = {"x86_64": 314, "aarch64": 274}
_ATTRIBUTES = struct.Struct("<IIQiIQQQ")  # size, policy, flags, nice, priority, runtime, deadline, period


def wait_until(clock: Clock, time_s: float) -> None:
    """Returns at bench time `time_s` [s], and no later than that for having slept."""
    clock.sleep_until(time_s - EARLY_S)
    for _ in range(_LOOKS):
        if clock.now_s() >= time_s:
            return
    clock.sleep_until(time_s)


@contextmanager
def short_turns() -> Iterator[None]:
    """While open, this thread gets short turns and is woken up promptly, where the system can do that."""
    niceness = _niceness()
    asked = _ask(niceness, TURN_NS)
    try:
        yield
    finally:
        if asked:
            _ask(niceness, 0)


def _niceness() -> int:
    return os.getpriority(os.PRIO_PROCESS, 0) if hasattr(os, "getpriority") else 0


def _ask(niceness: int, turn_ns: int) -> bool:
    """Sets the length of a turn; 0 is the usual one. False where it is refused, or not known."""
    number = _SYSCALL.get(platform.machine())
    if sys.platform != "linux" or number is None:
        return False
    if os.sched_getscheduler(0) != os.SCHED_OTHER:  # whoever chose another policy knows why
        return False
    attributes = _ATTRIBUTES.pack(_ATTRIBUTES.size, 0, 0, niceness, 0, turn_ns, 0, 0)
    return int(ctypes.CDLL(None, use_errno=True).syscall(number, 0, attributes, 0)) == 0
