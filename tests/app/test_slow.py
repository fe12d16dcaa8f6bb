"""What takes long is said, what does not is not."""

from __future__ import annotations

import threading

from app.slow import STARTING, say_if_slow


def test_what_takes_long_is_said_while_it_goes_on() -> None:
    said, heard = threading.Event(), []
    with say_if_slow("compiling", 0.0, lambda text: (heard.append(text), said.set())):
        assert said.wait(20.0)
    assert heard == ["compiling"]


def test_a_busy_machine_is_not_told_that_it_compiles() -> None:
    assert STARTING.startswith("starting the virtual valve; the first time")


def test_what_is_done_at_once_is_not_said() -> None:
    heard: list[str] = []
    before = threading.active_count()
    with say_if_slow("compiling", 3600.0, heard.append):
        pass
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.join(20.0)
    assert heard == []
    assert threading.active_count() == before
