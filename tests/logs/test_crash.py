"""What a killed program leaves behind can be read, up to the last half second, and says that it was killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hal.errors import BadInput
from logs.layout import EVENTS, SAMPLES, START, STOP
from logs.load import recording_of_run
from logs.recording import FloatArray
from logs.run import read_run
from logs.writer import RunWriter
from tests.logs.runs import valve_columns, write_run

WRITER = """
import sys, time
from pathlib import Path
from logs.writer import RunWriter
writer = RunWriter.create(Path(sys.argv[1]), {"kind": "killed"}, {"time_s": "s", "position_in": "in"})
begin, number = time.monotonic(), 0
while True:
    number += 1
    writer.append({"time_s": time.monotonic() - begin, "position_in": 0.25})
    if number == 5: writer.event(0.0, "info", "started")
    print(time.monotonic() - begin, flush=True)
    time.sleep(0.005)
"""


def test_kill_minus_nine_costs_at_most_the_last_second(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    process = subprocess.Popen([sys.executable, "-c", WRITER, str(folder)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    lines = [process.stdout.readline() for _ in range(230)]
    os.kill(process.pid, signal.SIGKILL)
    lines += process.stdout.readlines()
    process.wait()
    handed = [float(line) for line in lines if line.endswith("\n")]
    run = read_run(folder)
    assert run.status == "crash" and "no stop document" in run.problems[0]
    assert run.start["kind"] == "killed" and [event.text for event in run.events] == ["started"]
    assert np.all(np.diff(run.columns["time_s"]) > 0)
    assert handed[-1] - run.columns["time_s"][-1] < 1.0
    assert run.rows > 100


def in_batches(folder: Path, rows: int = 400, size: int = 40) -> dict[str, FloatArray]:
    """A record whose rows went to disk in batches of `size`, without a stop document."""
    columns = valve_columns(rows)
    writer = RunWriter.create(folder, {"kind": "torn"}, dict.fromkeys(columns, ""))
    for k in range(rows):
        writer.append({name: float(values[k]) for name, values in columns.items()})
        if k % size == size - 1:
            writer.flush()
    writer.close("success", "done")
    (folder / STOP).unlink()
    return columns


def test_a_tail_torn_anywhere_costs_only_the_batch_it_is_in(tmp_path: Path) -> None:
    columns = in_batches(tmp_path / "run")
    samples = tmp_path / "run" / SAMPLES
    whole = samples.read_bytes()
    per_batch = len(whole) / 10
    counts = []
    for cut in sorted(np.random.default_rng(3).integers(0, len(whole), 120)):
        samples.write_bytes(whole[:cut])
        run = read_run(tmp_path / "run")
        assert run.status == "crash" and run.problems
        assert set(run.columns) == set(columns)
        assert np.array_equal(run.columns["time_s"], columns["time_s"][: run.rows])
        assert run.rows >= 40 * (cut // per_batch - 2)
        counts.append(run.rows)
    assert counts == sorted(counts) and counts[-1] >= 360


def test_a_damaged_tail_of_a_finished_run_is_said(tmp_path: Path) -> None:
    write_run(tmp_path / "run", valve_columns(200))
    samples = tmp_path / "run" / SAMPLES
    samples.write_bytes(samples.read_bytes()[:-700])
    run = read_run(tmp_path / "run")
    assert run.status == "success" and run.rows < 200
    assert any(f"{run.rows} of the 200 rows" in problem for problem in run.problems)


def test_a_torn_event_line_costs_only_itself(tmp_path: Path) -> None:
    write_run(tmp_path / "run", valve_columns(100))
    events = tmp_path / "run" / EVENTS
    whole = len(read_run(tmp_path / "run").events)
    events.write_bytes(events.read_bytes()[:-9])
    run = read_run(tmp_path / "run")
    assert len(run.events) == whole - 1
    assert any("torn line" in problem for problem in run.problems)


def test_a_lost_start_document_is_found_in_the_samples(tmp_path: Path) -> None:
    write_run(tmp_path / "run", valve_columns(60))
    (tmp_path / "run" / START).unlink()
    run = read_run(tmp_path / "run")
    assert run.kind == "staircase" and run.rows == 60 and "run.json cannot be read" in run.problems


def test_killed_before_the_first_batch_there_are_columns_and_no_rows(tmp_path: Path) -> None:
    write_run(tmp_path / "run", valve_columns(60))
    (tmp_path / "run" / STOP).unlink()
    (tmp_path / "run" / SAMPLES).write_bytes(b"")
    run = read_run(tmp_path / "run")
    assert run.rows == 0 and run.units["pressure_psi"] == "psi" and run.status == "crash"
    with pytest.raises(BadInput, match="holds 0 samples"):
        recording_of_run(run)


def test_a_stop_document_that_says_nonsense_is_no_stop_document(tmp_path: Path) -> None:
    write_run(tmp_path / "run", valve_columns(60))
    (tmp_path / "run" / STOP).write_text(json.dumps({"status": "splendid"}))
    assert read_run(tmp_path / "run").status == "crash"


@pytest.mark.parametrize("what", ["missing", "empty folder", "file"])
def test_what_is_no_run_is_refused_with_its_name(tmp_path: Path, what: str) -> None:
    path = tmp_path / "thing"
    if what == "empty folder":
        path.mkdir()
    if what == "file":
        path.write_text("x")
    with pytest.raises(BadInput, match="thing"):
        read_run(path)
