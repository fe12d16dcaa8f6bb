"""The loop of the view's process, in this one: what comes out of the pipe is handed on until the pipe ends."""

from __future__ import annotations

import os

from hal.clock import SteppedClock
from logs.run import Event
from logs.view_process import work
from logs.view_wire import Row, pack_event, pack_row


class Shown:
    def __init__(self) -> None:
        self.items: list[Row | Event] = []
        self.closed = False

    def take(self, items: list[Row | Event]) -> None:
        assert not self.closed
        self.items += items

    def close(self) -> None:
        self.closed = True


def test_everything_is_handed_on_and_the_end_of_the_pipe_is_the_end() -> None:
    ours, theirs = os.pipe()
    event = Event(1.0, "info", "said")
    os.write(theirs, pack_row((1.0, 2.0)) + pack_event(event) + pack_row((2.0, 3.0)) + b"r")  # and a torn one
    os.close(theirs)
    shown = Shown()
    work(ours, shown, SteppedClock())  # type: ignore[arg-type]
    os.close(ours)
    assert shown.items == [(1.0, 2.0), event, (2.0, 3.0)]
    assert shown.closed
