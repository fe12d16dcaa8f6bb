"""`lostmotion jog` with steps from standard input: a terminal, or something that nobody types into."""

from __future__ import annotations

import os
import sys
import tty

import pytest

from app.cli import run

WORDS = ["jog", "--dwell", "0.1"]


def steps(out: str) -> list[str]:
    return [line for line in out.splitlines() if line.startswith("->")]


@pytest.mark.parametrize("text", ["+2\nup\n+1\n", "+2\nup"], ids=["in the middle", "last, without a newline"])
def test_a_bad_line_of_a_pipe_ends_the_session(text, monkeypatch, capsys) -> None:
    ours, theirs = os.pipe()
    os.write(theirs, text.encode())
    os.close(theirs)
    monkeypatch.setattr(sys, "stdin", os.fdopen(ours))
    assert run(WORDS) == 2
    said = capsys.readouterr()
    assert steps(said.out) == ["-> 2 psi"]
    assert said.err.endswith("step 'up' must look like +0.5, -1 or =8; the valve is at its safe command\n")


def test_the_last_step_of_a_pipe_needs_no_newline(monkeypatch, capsys) -> None:
    ours, theirs = os.pipe()
    os.write(theirs, b"+2\n+1")
    os.close(theirs)
    monkeypatch.setattr(sys, "stdin", os.fdopen(ours))
    assert run(WORDS) == 0
    assert steps(capsys.readouterr().out) == ["-> 2 psi", "-> 3 psi"]


def test_a_bad_line_at_a_terminal_is_said_and_passed_over(monkeypatch, capsys) -> None:
    ours, theirs = os.openpty()
    tty.setraw(ours)
    os.write(theirs, b"+2\nup\n+1\nq\n")
    monkeypatch.setattr(sys, "stdin", os.fdopen(ours))
    assert run(WORDS) == 0
    os.close(theirs)
    said = capsys.readouterr()
    assert steps(said.out) == ["-> 2 psi", "-> 3 psi"]
    assert "step 'up' must look like" in said.err
