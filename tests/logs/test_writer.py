"""The writer: what is on disk when, what a record says of itself, and what cannot happen to it."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from hal.errors import BadInput, JobFailed
from logs.layout import EVENTS, SAMPLES, START, STOP
from logs.run import read_run
from logs.writer import RunWriter
from tests.logs.runs import UNITS, valve_columns, write_run

TWO = {"time_s": "s", "position_in": "in"}


def test_what_is_written_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    columns = valve_columns(777)
    write_run(tmp_path / "run", columns)
    run = read_run(tmp_path / "run")
    assert run.status == "success" and run.reason == "finished" and run.problems == ()
    assert run.rows == 777
    for name, values in columns.items():
        assert np.array_equal(run.columns[name], values), name
        assert run.units[name] == UNITS[name]


def test_the_start_document_is_there_before_the_first_sample(tmp_path: Path) -> None:
    writer = RunWriter.create(tmp_path / "run", {"kind": "ramp", "seed": 4, "note": "cold valve"}, TWO)
    start = json.loads((tmp_path / "run" / START).read_text())
    assert start["kind"] == "ramp" and start["seed"] == 4 and start["note"] == "cold valve"
    assert {"uuid", "utc", "argv", "version", "git", "python", "host"} <= start.keys()
    assert start["columns"] == TWO
    writer.close("abort", "operator")


def test_a_record_being_written_reads_as_running_and_holds_what_was_flushed(tmp_path: Path) -> None:
    writer = RunWriter.create(tmp_path / "run", {}, TWO)
    writer.append({"time_s": 0.0, "position_in": 0.1})
    writer.event(0.0, "warning", "supply low")
    writer.flush()
    run = read_run(tmp_path / "run")
    assert run.status == "running" and run.rows == 1 and run.problems == ()
    assert [(event.level, event.text) for event in run.events] == [("warning", "supply low")]
    writer.close("success", "done")


def test_a_column_left_out_of_a_row_is_nan(tmp_path: Path) -> None:
    with RunWriter.create(tmp_path / "run", {}, TWO) as writer:
        writer.append({"time_s": 1.0})
    assert math.isnan(read_run(tmp_path / "run").columns["position_in"][0])


def test_a_column_nobody_declared_is_a_defect_and_says_its_name(tmp_path: Path) -> None:
    with RunWriter.create(tmp_path / "run", {}, TWO) as writer, pytest.raises(ValueError, match="preasure_psi"):
        writer.append({"time_s": 0.0, "preasure_psi": 1.0})


def test_a_folder_with_anything_in_it_is_refused_and_left_alone(tmp_path: Path) -> None:
    precious = tmp_path / "precious.txt"
    precious.write_text("keep")
    with pytest.raises(BadInput, match="not empty"):
        RunWriter.create(tmp_path, {}, TWO)
    assert [each.name for each in tmp_path.iterdir()] == ["precious.txt"] and precious.read_text() == "keep"


def test_a_folder_that_cannot_be_made_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="no run can be recorded there"):
        RunWriter.create(tmp_path / "file" / "run", {}, TWO)


def test_default_folders_do_not_collide(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    writers = [RunWriter.create(None, {"kind": "hold"}, TWO) for _ in range(3)]
    assert len({writer.folder for writer in writers}) == 3
    assert all(writer.folder.parent == Path("logs/runs") and "-hold" in writer.folder.name for writer in writers)
    for writer in writers:
        writer.close("success", "done")


@pytest.mark.parametrize(
    ("error", "status", "reason"),
    [
        (None, "success", "finished"),
        (KeyboardInterrupt(), "abort", "operator"),
        (JobFailed("no air"), "fail", "no air"),
    ],
)
def test_leaving_the_block_closes_the_record(
    tmp_path: Path, error: BaseException | None, status: str, reason: str
) -> None:
    def leave() -> None:
        with RunWriter.create(tmp_path / "run", {}, TWO):
            if error is not None:
                raise error

    if error is None:
        leave()
    else:
        with pytest.raises(type(error)):
            leave()
    run = read_run(tmp_path / "run")
    assert run.status == status and reason in run.reason


def test_the_first_close_counts(tmp_path: Path) -> None:
    writer = RunWriter.create(tmp_path / "run", {}, TWO)
    writer.close("fail", "wire")
    writer.close("success", "never mind")
    assert read_run(tmp_path / "run").reason == "wire"


def test_a_disk_that_refuses_stops_the_run_instead_of_losing_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = RunWriter.create(tmp_path / "run", {}, TWO)

    def full(rows: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(writer._sink, "write_rows", full)
    writer.append({"time_s": 0.0})
    with pytest.raises(JobFailed, match="No space left on device"):
        writer.flush()
    with pytest.raises(JobFailed, match="can no longer be written"):
        writer.append({"time_s": 1.0})
    with pytest.raises(JobFailed):
        writer.close("success", "done")
    assert not (tmp_path / "run" / STOP).exists()


def test_the_samples_file_describes_itself(tmp_path: Path) -> None:
    import pyarrow as pa

    write_run(tmp_path / "run", valve_columns(100))
    schema = pa.ipc.open_stream((tmp_path / "run" / SAMPLES).open("rb")).schema
    assert json.loads(schema.metadata[b"start"])["kind"] == "staircase"
    assert schema.field("pressure_psi").metadata[b"unit"] == b"psi"


def test_values_json_cannot_hold_do_not_break_a_document(tmp_path: Path) -> None:
    start = {"a": float("nan"), "b": np.float64(2.0), "c": tmp_path, "d": (1, np.int64(2)), "e": {"f": float("inf")}}
    RunWriter.create(tmp_path / "run", start, TWO).close("success", "done")
    document = json.loads((tmp_path / "run" / START).read_text())
    assert (document["a"], document["b"], document["d"], document["e"]) == (None, 2.0, [1, 2], {"f": None})


def test_many_rows_at_once_arrive_whole_and_in_order(tmp_path: Path) -> None:
    with RunWriter.create(tmp_path / "run", {}, TWO) as writer:
        for number in range(20_000):
            writer.append({"time_s": float(number)})
    assert np.array_equal(read_run(tmp_path / "run").columns["time_s"], np.arange(20_000.0))
    assert (tmp_path / "run" / EVENTS).read_bytes() == b""
