from __future__ import annotations

import ctypes
import os
import platform
import sys

import pytest

from hal import promptly
from hal.clock import SteppedClock

GET = {"x86_64": 315, "aarch64": 275}


def turn_ns() -> int:
    """What the kernel says of this thread (sched_getattr)."""
    room = ctypes.create_string_buffer(promptly._ATTRIBUTES.size)
    assert ctypes.CDLL(None).syscall(GET[platform.machine()], 0, room, len(room), 0) == 0
    return int(promptly._ATTRIBUTES.unpack(room.raw)[5])


class Looked(SteppedClock):
    """Virtual time in which `looks` looks at the clock cost a microsecond each, and further ones nothing."""

    def __init__(self, looks: int) -> None:
        super().__init__()
        self._looks = looks

    def now_s(self) -> float:
        if self._looks:
            self._looks -= 1
            self.sleep_until(super().now_s() + 1e-6)
        return super().now_s()


@pytest.mark.parametrize("looks", [0, 10, 1000], ids=["a clock that stands still", "one that stops", "one that runs"])
def test_waiting_ends_at_the_moment_whatever_the_clock_does(looks: int) -> None:
    clock = Looked(looks)
    promptly.wait_until(clock, 0.005)
    assert clock.now_s() == pytest.approx(0.005, abs=3e-6)


def test_turns_are_short_while_it_is_open_and_as_before_afterwards() -> None:
    before = os.getpriority(os.PRIO_PROCESS, 0)
    known = sys.platform == "linux" and platform.machine() in GET
    usual = turn_ns() if known else 0
    with promptly.short_turns():
        if usual:  # a kernel that tells no length gives none either
            assert turn_ns() == promptly.TURN_NS
        assert os.getpriority(os.PRIO_PROCESS, 0) == before
    assert not usual or turn_ns() == usual


@pytest.mark.parametrize(("name", "value"), [("machine", "vax"), ("platform", "plan9")])
def test_where_it_is_not_known_nothing_happens(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    if name == "machine":
        monkeypatch.setattr(platform, "machine", lambda: value)
    else:
        monkeypatch.setattr(sys, "platform", value)
    assert not promptly._ask(0, promptly.TURN_NS)
    with promptly.short_turns():
        pass
