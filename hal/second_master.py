"""Does somebody else command the device between two ticks? What it holds just before we write tells.

A read-back after our own write (function 23 writes before it reads) is our own value, whoever wrote before. So about
once a second the command that the device holds is read before the next one goes out.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import inf

from hal.assemble import NO_VALUE
from hal.errors import DeviceRefused, SafetyTrip, WireFault
from hal.pdu import Request
from hal.readback import ReadbackCheck
from hal.reply import Reply
from hal.tick import Block, TickPlan
from hal.watchdog import WatchdogControl, taken_over

LOOK_S = 1.0  # between two looks, while nothing is amiss
WINDOW_S = 10.0  # after somebody else's command every tick is looked at for so long
_MISMATCHES = 3  # somebody else's commands within `WINDOW_S`; as many as `hal.readback` allows in a row
_WHO = "does somebody else command it?"
_NOTICE_S = 1.5  # from the first of them on: meanwhile another program of ours looks, too, so that neither ends well


class SecondMaster:
    """Compares what the device holds with what it was sent last. Without a read-back in the profile nothing is read.

    `readback` says how far the two may differ, and names the device in the sentence. Ticks less than `room_s`
    apart have no time for a look; a command that is late each second would be worse.
    """

    def __init__(self, plan: TickPlan, room_s: float, watchdog: WatchdogControl, readback: ReadbackCheck) -> None:
        self._held = plan.held
        self._room_s = room_s
        self._began_s = -inf  # of the last tick
        self._watchdog = watchdog
        self._rule = readback
        self._sent: float | None = None  # None: what the device should hold is not known
        self._due_s = 0.0
        self._seen_s: deque[float] = deque()  # when somebody else's commands were seen, at most `WINDOW_S` ago
        self._last = ""

    def sent(self, command: float | None) -> None:
        """The device has confirmed this command; None: it may hold anything, and the next look says nothing."""
        self._sent = command

    def look(self, now_s: float, ask: Callable[[Request], Reply | None]) -> float | None:
        """The command that the device holds, where a look is due and it is not the one that it was sent; else None.

        Whoever looks is about to write: what the device holds then is not known before `sent`.
        Raises: `SafetyTrip` when the device has taken over itself, and after three of somebody else's commands
        within `WINDOW_S`; what `ask` raises.
        """
        expected, self._sent = self._sent, None
        hurried, self._began_s = now_s - self._began_s < self._room_s, now_s
        if expected is None or self._held is None or hurried or now_s < self._due_s:
            return None
        held = self._read(self._held, ask)
        if held is not None and abs(held - expected) <= self._rule.tolerance:
            held = None
        if held is not None:
            self._saw(now_s, expected, held)
        while self._seen_s and now_s - self._seen_s[0] > WINDOW_S:
            self._seen_s.popleft()
        if len(self._seen_s) >= _MISMATCHES and now_s - self._seen_s[0] >= _NOTICE_S:
            raise SafetyTrip(f"{self._last}, {len(self._seen_s)} times in {now_s - self._seen_s[0]:.1f} s: {_WHO}")
        self._due_s = now_s if self._seen_s else now_s + LOOK_S
        return held

    def _saw(self, now_s: float, expected: float, held: float) -> None:
        if self._took_over():
            raise taken_over(self._rule.where)
        where, unit = self._rule.where, self._rule.unit
        self._seen_s.append(now_s)
        self._last = f"the device on {where} was sent {expected:.4g} {unit} and held {held:.4g} {unit}"

    @staticmethod
    def _read(block: Block, ask: Callable[[Request], Reply | None]) -> float | None:
        reply = ask(block.request())
        if reply is None:
            return None
        value, quality = block.channels[0].value(reply.words)
        return None if quality & NO_VALUE else value

    def _took_over(self) -> bool:
        """A device that has timed out, or was stopped, holds its safe value for a reason of its own."""
        try:
            return self._watchdog.tripped()
        except (WireFault, DeviceRefused):
            return False
