from __future__ import annotations

import threading

from hal.deadman import Deadman


def test_it_acts_once_when_nobody_feeds_it() -> None:
    acted = threading.Event()
    deadman = Deadman(0.01, acted.set)
    deadman.start()
    assert acted.wait(5.0)
    deadman.stop()


def test_it_does_not_act_when_stopped_in_time() -> None:
    acted = threading.Event()
    deadman = Deadman(60.0, acted.set)
    deadman.start()
    deadman.stop()
    assert not acted.is_set()
    assert not deadman._thread.is_alive()


def test_feeding_puts_it_off() -> None:
    class Times:
        """Told what time it is, one answer after the other."""

        def __init__(self) -> None:
            self.now = 0.0

        def now_s(self) -> float:
            return self.now

        def sleep_until(self, time_s: float) -> None: ...

    clock, acted = Times(), threading.Event()
    deadman = Deadman(1.0, acted.set, clock)
    clock.now = 5.0
    deadman.feed()
    clock.now = 5.9
    deadman._done.set()  # look once
    deadman._watch()
    assert not acted.is_set()
    clock.now = 6.0
    deadman._watch()
    assert acted.is_set()
