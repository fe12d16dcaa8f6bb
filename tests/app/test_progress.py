"""Progress is shown, and nothing else is changed by it."""

from __future__ import annotations

import pytest

from app.progress import counted


def test_the_results_come_through_in_order_and_a_pipe_sees_no_bar(capsys: pytest.CaptureFixture[str]) -> None:
    assert counted((n * n for n in range(4)), 4, "squares") == [0, 1, 4, 9]
    said = capsys.readouterr()
    assert said.out == said.err == ""
