"""Finding runs by what is typed, summing them up, and adding notes."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from hal.errors import BadInput
from logs.find import find_record, run_folders, summarize
from logs.layout import EVENTS, SAMPLES, STOP
from logs.notes import add_note
from logs.run import read_run
from logs.writer import RunWriter
from tests.logs.runs import valve_columns, write_run


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name in ("20260101-ramp", "20260102-ramp", "deep/20260103-hold"):
        write_run(tmp_path / "runs" / name, valve_columns(30))
    (tmp_path / "runs" / "notes.txt").write_text("not a run")
    return tmp_path / "runs"


def test_runs_come_in_the_order_they_were_started(root: Path) -> None:
    assert [folder.name for folder in run_folders(root)] == ["20260101-ramp", "20260102-ramp", "20260103-hold"]
    assert run_folders(root / "none") == []


def test_a_run_is_found_by_path_name_part_and_latest(root: Path) -> None:
    hold = root / "deep" / "20260103-hold"
    for text in (str(hold), "20260103-hold", "hold", "latest"):
        assert find_record(text, root) == hold
    assert find_record(str(root / "notes.txt"), root) == root / "notes.txt"


@pytest.mark.parametrize(("text", "words"), [("ramp", "fits 2 runs"), ("nothing", "neither a file nor a run")])
def test_what_fits_none_or_several_is_refused(root: Path, text: str, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        find_record(text, root)


def test_a_summary_needs_no_samples_and_tells_a_crash(root: Path) -> None:
    folder = root / "20260101-ramp"
    summary = summarize(folder)
    assert (summary.kind, summary.status, summary.rows) == ("staircase", "success", 30)
    assert summary.seconds == pytest.approx(2.9)
    (folder / STOP).unlink()
    crashed = summarize(folder)
    assert (crashed.status, crashed.rows) == ("crash", 30) and crashed.seconds == pytest.approx(2.9)
    (folder / SAMPLES).write_bytes(b"torn")
    assert summarize(folder).rows == 0


def test_a_note_after_the_end_has_no_bench_time(root: Path) -> None:
    folder = root / "20260101-ramp"
    assert add_note(folder, "valve was cold: 5 °C") is None
    note = read_run(folder).events[-1]
    assert (note.kind, note.text, note.time_s) == ("note", "valve was cold: 5 °C", None) and note.utc


def test_a_note_during_a_run_stands_at_its_last_sample_and_both_keep_their_lines(tmp_path: Path) -> None:
    writer = RunWriter.create(tmp_path / "run", {}, {"time_s": "s"})
    writer.append({"time_s": 4.5})
    writer.flush()

    def write_events() -> None:
        for number in range(200):
            writer.event(float(number), "info", "x" * 300)

    thread = threading.Thread(target=write_events)
    thread.start()
    times = [add_note(tmp_path / "run", f"note {number}") for number in range(10)]
    thread.join()
    writer.close("success", "done")
    run = read_run(tmp_path / "run")
    assert times == [4.5] * 10 and run.problems == () and len(run.events) == 210


def test_a_note_does_not_stick_to_a_torn_line(root: Path) -> None:
    events = root / "20260101-ramp" / EVENTS
    events.write_bytes(events.read_bytes()[:-5])
    add_note(events.parent, "after the crash")
    assert read_run(events.parent).events[-1].text == "after the crash"


def test_a_note_needs_a_run(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="notes go into run folders"):
        add_note(tmp_path, "x")
