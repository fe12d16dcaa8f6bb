"""What a table looks like in a pipe."""

from __future__ import annotations

import pytest

from app.tables import console, new_table


def test_units_in_brackets_are_shown_and_lines_are_not_broken(capsys: pytest.CaptureFixture[str]) -> None:
    table = new_table("held [in]", ("name", "position [in]", "settled\n[s]"), left=("name",))
    table.add_row("a" * 60, "0.1", "2")
    console().print(table)
    said = capsys.readouterr().out
    assert all(words in said for words in ("held [in]", "position [in]", "[s]", "a" * 60))
    assert "\x1b[" not in said
