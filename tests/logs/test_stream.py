"""The live view and its process: shows what it gets, drops what it cannot keep up with, and never fails a run."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from hal.clock import RealClock
from logs import stream
from logs.ports import listens
from logs.stream import RunView
from tests.logs.runs import DESIGN, UNITS, valve_columns
from tests.logs.test_rrd import contents

START = {"kind": "staircase", "design": DESIGN}
SHORT = {"time_s": "s", "position_in": "in"}


def feed(view: RunView, rows: int = 300) -> None:
    columns = valve_columns(rows)
    for k in range(rows):
        view.append({name: float(values[k]) for name, values in columns.items()})


def _ended(process_id: int) -> bool:
    try:
        # /proc says "Z" of a process whose other threads still hold its end of the pipe; this does not
        return os.waitid(os.P_PID, process_id, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
    except ChildProcessError:  # somebody else's child
        with suppress(OSError):
            return Path(f"/proc/{process_id}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
        return True


def gone(process_id: int, patience_s: float = 20.0) -> bool:
    """Whether the process ends in time; a child of ours that has ended is waited for."""
    clock = RealClock()
    end_s = clock.now_s() + patience_s
    while clock.now_s() < end_s:
        if _ended(process_id):
            return True
        clock.sleep_until(clock.now_s() + 0.02)
    return False


def test_a_view_holds_every_row_and_word_and_is_served_on_the_loopback_address_alone(tmp_path: Path) -> None:
    columns = {name: UNITS[name] for name in valve_columns(2)}
    with RunView.open(START, columns, file=tmp_path / "view.rrd") as view:
        assert view.on
        port = int(view.uri.rpartition(":")[2].partition("/")[0])
        assert view.uri == f"rerun+http://127.0.0.1:{port}/proxy" and listens(port, patience_s=1.0)
        for line in Path("/proc/net/tcp").read_text().splitlines()[1:] if Path("/proc/net/tcp").exists() else []:
            address, _, local = line.split()[1].partition(":")
            if int(local, 16) == port and line.split()[3] == "0A":
                assert address == "0100007F"
        view.state(0.0, "running")
        view.event(1.0, "error", "no reply")
        with socket.create_connection(("127.0.0.1", port)) as peer:  # connects and then never reads: a frozen viewer
            peer.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")
            feed(view, 2000)
            view.note(2.0, "a note")
            view.close()
    rows, blueprints = contents(tmp_path / "view.rrd")
    assert rows["/pressure"] == rows["/position"] == rows["/timing"] == 2001
    assert rows["/log/event"] == rows["/log/note"] == 1 and rows["/plane/trail"] >= 1
    assert blueprints == 1 and view.dropped == 0 and view.trouble == ""


def test_a_file_that_cannot_be_written_turns_the_view_off(tmp_path: Path) -> None:
    view = RunView.open(START, {"time_s": "s"}, serve=False, file=tmp_path / "none" / "view.rrd")
    assert not view.on and "No such file" in view.trouble and "the run and its record go on" in view.trouble
    view.append({"time_s": 0.0})
    view.event(0.0, "info", "goes nowhere")
    view.close()
    view.close()


def test_a_process_that_dies_turns_the_view_off_and_the_row_is_still_taken() -> None:
    view = RunView.open(START, SHORT, serve=False)
    os.kill(view.process_id, signal.SIGKILL)
    assert gone(view.process_id)
    for k in range(3):
        view.append({"time_s": float(k)})
    assert not view.on and "its process is gone" in view.trouble
    view.close()
    assert "its process is gone" in view.trouble


def test_an_error_of_rerun_is_told_with_its_words() -> None:
    view = RunView.open(START, {"pressure_psi": "psi"}, serve=False)  # a run without time: nothing can be drawn
    view.append({"pressure_psi": 0.0})
    view.close()
    assert "ValueError" in view.trouble


def test_a_process_that_does_not_start_in_time_turns_the_view_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "PATIENCE_S", 0.0)
    view = RunView.open(START, SHORT, serve=False)
    assert "did not start within" in view.trouble and not view.on
    view.close()


def test_a_view_that_cannot_keep_up_drops_and_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "CAPACITY_ROWS", 100)
    view = RunView.open(START, SHORT, serve=False, file=tmp_path / "view.rrd")
    os.kill(view.process_id, signal.SIGSTOP)
    sent = 0
    while not view.dropped:
        view.append({"time_s": float(sent), "position_in": 0.0})
        sent += 1
    os.kill(view.process_id, signal.SIGCONT)
    view.close()
    rows, _ = contents(tmp_path / "view.rrd")
    assert rows["/position"] == 1 + sent - 1  # its name, and all but the one that was dropped
    assert view.dropped == 1 and rows["/log/event"] == 1 and view.trouble == ""


def test_the_view_dies_with_a_run_that_is_killed(tmp_path: Path) -> None:
    script = (
        "import json, os, signal, sys, pathlib; from logs.stream import RunView\n"
        f"view = RunView.open({{}}, {SHORT!r}, file=pathlib.Path(sys.argv[1]))\n"
        "view.append({'time_s': 0.0, 'position_in': 0.1})\n"
        "print(json.dumps([view.process_id, view.trouble]), flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    file = tmp_path / "view.rrd"
    ran = subprocess.run(
        [sys.executable, "-c", script, str(file)], check=False, capture_output=True, text=True, timeout=60
    )
    process_id, trouble = json.loads(ran.stdout)
    assert ran.returncode == -signal.SIGKILL and trouble == ""
    assert gone(process_id)
    assert contents(file)[0]["/position"] == 2, "and the view holds what it was given"
