"""Our own runs as strangers see them: CSV, Parquet and the folder are one recording."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hal.errors import BadInput
from logs.export import write_csv, write_parquet
from logs.load import load_recording
from logs.open import open_record
from logs.run import read_run
from tests.logs.runs import UNITS, valve_columns, write_run
from tests.logs.strangers import HEAD, said


def test_a_run_its_csv_and_its_parquet_are_one_recording(tmp_path: Path) -> None:
    columns = valve_columns(300)
    columns["position_in"][7] = np.nan
    write_run(tmp_path / "run", columns)
    run = read_run(tmp_path / "run")
    write_csv(run, tmp_path / "run.csv")
    write_parquet(run, tmp_path / "run.parquet")
    recordings = [load_recording(tmp_path / name) for name in ("run", "run.csv", "run.parquet", "run/run.json")]
    for recording in recordings:
        assert np.array_equal(recording.time_s, columns["time_s"])
        assert np.array_equal(recording.command, columns["command_psi"])
        assert np.array_equal(recording.position, columns["position_in"], equal_nan=True)
        assert recording.pressure is not None and np.array_equal(recording.pressure, columns["pressure_psi"])
        assert [note.rows for note in recording.notes if "missing" in note.what] == [1]
    assert recordings[0].meta["status"] == "success"


def test_a_run_of_our_own_bench_is_read_without_the_units_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which takes as long to load as the run."""

    def asked(name: str, *_: object) -> tuple[float, float]:
        raise AssertionError(f"the units library was asked for {name}")

    write_run(tmp_path / "run", valve_columns(100))
    monkeypatch.setattr("logs.units._affine", asked)
    recording = load_recording(tmp_path / "run")
    assert recording.pressure is not None and recording.target is None


def test_a_run_says_what_its_bench_flagged(tmp_path: Path) -> None:
    columns = valve_columns(100)
    columns["quality"][40:43] = 1.0
    write_run(tmp_path / "run", columns)
    words = said(load_recording(tmp_path / "run"))
    assert "quality: readings flagged stale by the bench | kept as it is | 3 | 41" in words


def test_a_positioners_record_leaves_the_pressure_out(tmp_path: Path) -> None:
    columns = valve_columns(100)
    columns["command_percent"] = columns.pop("command_psi")
    write_run(tmp_path / "run", columns, units={name: UNITS.get(name, "percent") for name in columns})
    recording = load_recording(tmp_path / "run")
    assert recording.pressure is None and recording.pressure_unit == "percent"
    assert "a position in percent" in said(recording)


def test_a_folder_that_is_no_run_and_options_that_do_not_apply(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"without run\.json"):
        load_recording(tmp_path)
    write_run(tmp_path / "run", valve_columns(20))
    with pytest.raises(BadInput, match="leave out --map and --units"):
        load_recording(tmp_path / "run", units="time=ms")


def test_a_strangers_file_opens_as_a_run(tmp_path: Path) -> None:
    (tmp_path / "file.csv").write_text("time_ms,command_kPa,position_%\n0,20,1\n100,21,2\n")
    run = open_record(tmp_path / "file.csv")
    assert list(run.columns) == ["time_s", "command_psi", "position_percent"]
    assert run.rows == 2 and run.status == "success" and run.kind == "imported"


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-1e6, 1e6, allow_subnormal=False), min_size=2, max_size=40))
def test_any_numbers_survive_export_and_load(tmp_path_factory: pytest.TempPathFactory, values: list[float]) -> None:
    path = tmp_path_factory.mktemp("any") / "x.csv"
    lines = [f"{k * 0.1!r},3.0,{value!r}" for k, value in enumerate(values)]
    path.write_text("time_s,command_psi,position_in\n" + "\n".join(lines) + "\n")
    assert np.array_equal(load_recording(path).position, np.array(values))


def test_many_rows_in_little_time(tmp_path: Path) -> None:
    rows = 100_000
    path = tmp_path / "long.csv"
    block = "".join(f"{{t}}{k % 10},{3 + k % 7},{3 + k % 11 / 3:.4f},{k % 13 / 50:.4f}\n" for k in range(10))
    path.write_text(HEAD + "".join(block.replace("{t}", f"{k}.") for k in range(rows // 10)))
    begin = time.process_time()
    assert load_recording(path).n == rows
    assert time.process_time() - begin < 5.0  # measured 0.1 s; a loop over rows in Python would take longer than 5
