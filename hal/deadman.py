"""A thread that acts when the loop does not come round any more."""

from __future__ import annotations

import threading
from collections.abc import Callable

from hal.clock import Clock, RealClock


class Deadman:
    """Calls `act` once when `feed` was not called for `limit_s` of real time. A context manager."""

    def __init__(self, limit_s: float, act: Callable[[], None], clock: Clock | None = None) -> None:
        self._limit_s = limit_s
        self._act = act
        self._clock = clock or RealClock()
        self._fed_s = self._clock.now_s()
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="deadman", daemon=True)

    def start(self) -> None:
        self.feed()
        self._thread.start()

    def feed(self) -> None:
        self._fed_s = self._clock.now_s()

    def stop(self) -> None:
        self._done.set()
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(5.0)

    def _watch(self) -> None:
        while True:
            left_s = self._fed_s + self._limit_s - self._clock.now_s()
            if left_s <= 0.0:
                self._act()
                return
            if self._done.wait(left_s):
                return
