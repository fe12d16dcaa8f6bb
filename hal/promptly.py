"""Waking up on time beside other work: the scheduler is asked for short turns for the thread that keeps deadlines.

Without it a thread that wakes up waits until whoever runs has used up his turn, 3 ms on a usual Linux.
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

TURN_NS = 100_000  # the shortest that the kernel gives
_SYSCALL = {"x86_64": 314, "aarch64": 274}
_ATTRIBUTES = struct.Struct("<IIQiIQQQ")  # size, policy, flags, nice, priority, runtime, deadline, period


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
