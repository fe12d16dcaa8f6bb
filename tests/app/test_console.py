"""The progress bar and the notes from the keyboard."""

from __future__ import annotations

import os
import pty
import time

import pytest

from app.console import KeyboardNotes, RunDisplay
from control.loop import Progress
from hal.sample import Reading, Sample


def test_the_display_is_silent_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    sample = Sample(0.0, 9.0, Reading(0.1, 0.0, 0.0))
    with RunDisplay("staircase") as display:
        for tick in range(50):
            display.show(Progress(0.1 * tick, 5.0, 0, "step 0", sample))
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.strip() == ""


def test_lines_typed_at_a_terminal_become_notes(monkeypatch: pytest.MonkeyPatch) -> None:
    master, slave = pty.openpty()
    with os.fdopen(slave) as terminal:
        monkeypatch.setattr("sys.stdin", terminal)
        notes = KeyboardNotes()
        os.write(master, b"the fan is loud\n\n")
        heard: list[str] = []
        deadline = time.monotonic() + 5.0
        while not heard and time.monotonic() < deadline:
            heard += notes()
        notes.close()
        notes.join()
    os.close(master)
    assert heard == ["the fan is loud"]
    assert notes() == ()


def test_nothing_is_read_where_stdin_is_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    read, write = os.pipe()
    with os.fdopen(read) as pipe, os.fdopen(write, "w") as feed:
        monkeypatch.setattr("sys.stdin", pipe)
        notes = KeyboardNotes()
        feed.write("not for us\n")
        feed.flush()
        notes.close()
        assert notes() == ()
        assert pipe.readline() == "not for us\n"
