"""The live view: shows what it gets, drops what it cannot keep up with, and never fails a run."""

from __future__ import annotations

import socket
import threading
from pathlib import Path

import pytest

from logs import stream
from logs.ports import listens
from logs.stream import RunView
from tests.logs.runs import DESIGN, UNITS, valve_columns
from tests.logs.test_rrd import contents

START = {"kind": "staircase", "design": DESIGN}


def feed(view: RunView, rows: int = 300) -> None:
    columns = valve_columns(rows)
    for k in range(rows):
        view.append({name: float(values[k]) for name, values in columns.items()})


def test_a_file_view_holds_every_row_and_word(tmp_path: Path) -> None:
    columns = {name: UNITS[name] for name in valve_columns(2)}
    with RunView.open(START, columns, serve=False, file=tmp_path / "view.rrd") as view:
        assert view.on and view.uri == ""
        view.state(0.0, "running")
        view.event(1.0, "error", "no reply")
        feed(view)
        view.note(2.0, "a note")
    rows, blueprints = contents(tmp_path / "view.rrd")
    assert rows["/pressure"] == rows["/position"] == rows["/timing"] == 301
    assert rows["/log/event"] == rows["/log/note"] == 1 and rows["/plane/trail"] >= 1
    assert blueprints == 1 and view.dropped == 0 and view.trouble == ""


def test_the_service_listens_on_the_loopback_address_alone(tmp_path: Path) -> None:
    view = RunView.open(START, {"time_s": "s", "position_in": "in"})
    port = int(view.uri.rpartition(":")[2].partition("/")[0])
    assert view.uri == f"rerun+http://127.0.0.1:{port}/proxy" and listens(port, patience_s=1.0)
    for line in Path("/proc/net/tcp").read_text().splitlines()[1:] if Path("/proc/net/tcp").exists() else []:
        address, _, local = line.split()[1].partition(":")
        if int(local, 16) == port and line.split()[3] == "0A":
            assert address == "0100007F"
    view.close()
    view.close()
    assert view.trouble == ""


def test_a_port_that_is_taken_turns_the_view_off_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))  # bound, not listening: nobody else can have it, nobody answers
        monkeypatch.setattr(stream, "free_port", lambda: taken.getsockname()[1])
        monkeypatch.setattr(stream, "listens", lambda port, patience_s: listens(port, 0.0))
        view = RunView.open(START, {"time_s": "s"})
    assert not view.on and view.uri == "" and "the run and its record go on" in view.trouble
    view.append({"time_s": 0.0})
    view.event(0.0, "info", "goes nowhere")
    view.close()


def test_a_file_that_cannot_be_written_turns_the_view_off(tmp_path: Path) -> None:
    view = RunView.open(START, {"time_s": "s"}, serve=False, file=tmp_path / "none" / "view.rrd")
    assert not view.on and "No such file" in view.trouble
    view.close()


def test_an_error_while_sending_turns_the_view_off_and_the_row_is_still_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failed = threading.Event()

    def refuse(*_: object) -> None:
        failed.set()
        raise RuntimeError("rerun is unwell")

    monkeypatch.setattr(stream, "send_samples", refuse)
    view = RunView.open(START, {"time_s": "s"}, serve=False, file=tmp_path / "view.rrd")
    view.append({"time_s": 0.0})
    assert failed.wait(5.0)
    view.close()
    view.append({"time_s": 1.0})
    assert "rerun is unwell" in view.trouble and not view.on


def test_a_view_that_cannot_keep_up_drops_and_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stuck, release = threading.Event(), threading.Event()
    real = stream.send_samples

    def slow(*arguments: object) -> None:
        stuck.set()
        release.wait(10.0)
        real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(stream, "send_samples", slow)
    monkeypatch.setattr(stream, "CAPACITY_ROWS", 100)
    view = RunView.open(START, {"time_s": "s", "position_in": "in"}, serve=False, file=tmp_path / "view.rrd")
    view.append({"time_s": 0.0})
    assert stuck.wait(5.0)
    for number in range(250):
        view.append({"time_s": 1.0 + number, "position_in": 0.0})
    assert view.dropped == 150
    release.set()
    view.close()
    rows, _ = contents(tmp_path / "view.rrd")
    assert rows["/position"] == 102 and rows["/log/event"] == 1  # names, the first, the hundred; and the warning


def test_a_viewer_that_freezes_does_not_hold_up_the_rows(tmp_path: Path) -> None:
    view = RunView.open(START, {name: UNITS[name] for name in valve_columns(2)}, file=tmp_path / "view.rrd")
    port = int(view.uri.rpartition(":")[2].partition("/")[0])
    with socket.create_connection(("127.0.0.1", port)) as peer:  # connects and then never reads: a frozen viewer
        peer.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")
        feed(view, 2000)
        view.close()
    rows, _ = contents(tmp_path / "view.rrd")
    assert rows["/pressure"] == 2001 and view.dropped == 0


def test_the_columns_may_hold_nan_and_only_nan(tmp_path: Path) -> None:
    with RunView.open(START, UNITS, serve=False, file=tmp_path / "view.rrd") as view:
        for k in range(20):
            view.append({"time_s": float(k)})
    assert view.trouble == ""
    rows, _ = contents(tmp_path / "view.rrd")
    assert rows["/pressure"] == 21
