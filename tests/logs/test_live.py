"""The rerun stream of a run: what it is given in blocks stands in the file."""

from __future__ import annotations

import socket
from pathlib import Path

import numpy as np
import pytest

from logs import live
from logs.live import LiveStream
from logs.ports import listens
from logs.run import Event
from tests.logs.runs import DESIGN, UNITS, valve_columns
from tests.logs.test_rrd import contents

START = {"kind": "staircase", "design": DESIGN}


def test_blocks_of_rows_and_words_are_all_in_the_file(tmp_path: Path) -> None:
    columns = valve_columns(300)
    stream = LiveStream(START, {name: UNITS[name] for name in columns}, False, tmp_path / "view.rrd")
    rows = [tuple(map(float, row)) for row in np.column_stack(list(columns.values()))]
    stream.take([Event(0.0, "info", "running", kind="state"), *rows[:100]])
    stream.take([])
    stream.take([*rows[100:], Event(1.0, "error", "no reply"), Event(2.0, "info", "a note", kind="note")])
    stream.close()
    found, blueprints = contents(tmp_path / "view.rrd")
    assert found["/pressure"] == found["/position"] == found["/timing"] == 301
    assert found["/log/event"] == found["/log/note"] == 1 and found["/plane/trail"] >= 1
    assert blueprints == 1 and stream.uri == ""


def test_rows_may_hold_nan_and_only_nan(tmp_path: Path) -> None:
    stream = LiveStream(START, UNITS, False, tmp_path / "view.rrd")
    stream.take([(float(k), *[float("nan")] * (len(UNITS) - 1)) for k in range(20)])
    stream.close()
    assert contents(tmp_path / "view.rrd")[0]["/pressure"] == 21


def test_a_port_that_is_taken_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))  # bound, not listening: nobody else can have it, nobody answers
        monkeypatch.setattr(live, "free_port", lambda: taken.getsockname()[1])
        monkeypatch.setattr(live, "listens", lambda port, patience_s: listens(port, 0.0))
        with pytest.raises(OSError, match="nothing answers"):
            LiveStream(START, {"time_s": "s"}, True, None)
