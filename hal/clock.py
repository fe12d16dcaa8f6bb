"""The only file that reads a clock. Everything else is handed a `Clock`."""

from __future__ import annotations

import threading
import time
from datetime import UTC, datetime
from typing import Protocol


class Clock(Protocol):
    """Bench time in seconds, monotonic, from an arbitrary origin."""

    def now_s(self) -> float:
        """The bench time now [s]."""

    def sleep_until(self, time_s: float) -> None:
        """Returns at bench time `time_s` [s], or at once if that has passed."""


class RealClock:
    """Bench time is the machine's monotonic time."""

    def now_s(self) -> float:
        return time.monotonic()

    def sleep_until(self, time_s: float) -> None:
        remaining_s = time_s - time.monotonic()
        if remaining_s > 0.0:
            time.sleep(remaining_s)


class SteppedClock:
    """Virtual time: it stands still until somebody sleeps, and then it is later. Shared by loop and virtual device.

    Deterministic, and as fast as the wire allows: a 20-minute sweep takes seconds.
    """

    def __init__(self, start_s: float = 0.0) -> None:
        self._now_s = start_s
        self._lock = threading.Lock()

    def now_s(self) -> float:
        with self._lock:
            return self._now_s

    def sleep_until(self, time_s: float) -> None:
        with self._lock:
            self._now_s = max(self._now_s, time_s)


def utc_now() -> datetime:
    """Calendar time, for documents that people read; never for measuring."""
    return datetime.now(UTC)
