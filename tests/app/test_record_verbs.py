"""The verbs around records, as a script would call them: what they print, write and return."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app.cli import run as lostmotion
from logs.layout import STOP, VIEW
from tests.logs.runs import valve_columns, write_run


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    path = Path("logs/runs/20260101-staircase")
    write_run(path, valve_columns(200))
    return path


def test_runs_lists_how_each_ended(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / STOP).unlink()
    write_run(Path("logs/runs/20260102-ramp"), valve_columns(20))
    assert lostmotion(["runs"]) == 0
    text = capsys.readouterr().out
    assert "20260101-staircase" in text and "crash" in text and "success" in text and "no stop document" in text
    assert lostmotion(["runs", "--json", "--last", "1"]) == 0
    (only,) = json.loads(capsys.readouterr().out)
    assert (only["name"], only["status"], only["rows"]) == ("20260102-ramp", "success", 20)


def test_runs_of_an_empty_folder_says_how_to_make_one(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("nowhere").mkdir()
    assert lostmotion(["runs", "nowhere"]) == 0
    assert "No runs under nowhere" in capsys.readouterr().out


def test_show_tells_the_story_of_a_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert lostmotion(["show", "latest"]) == 0
    text = capsys.readouterr().out
    for words in ("success", "200 samples, 19.9 s, one every 0.1 s", "supply at 60 psi", "Data quality", "lateness"):
        assert words in text
    assert lostmotion(["show", "latest", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["rows"] == 200 and document["data_quality"] == [] and document["start"]["seed"] == 1


def test_show_of_a_strangers_file_names_its_defects(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("x.csv").write_text("t;u;y\n0;20,5;1\n50;;1,5\n100;21;2\n")
    options = ["--map", "time=t,command=u,position=y", "--units", "time=ms,command=kPa,position=percent"]
    assert lostmotion(["show", "x.csv", *options]) == 0
    text = capsys.readouterr().out
    assert "u: missing values (row 2): the last command is held" in text
    assert "u: converted from kPa to psi" in text and "no pressure column" in text
    assert "command_psi" in text and "position_percent" in text


def test_export_writes_the_fixed_columns_first(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert lostmotion(["export", "latest", "--csv", "out.csv", "--parquet", "out.parquet"]) == 0
    lines = Path("out.csv").read_text().splitlines()
    assert lines[0].startswith("time_s,command_psi,pressure_psi,position_in,lateness_s") and len(lines) == 201
    values = np.loadtxt("out.csv", delimiter=",", skiprows=1)
    assert np.array_equal(values[:, 2], valve_columns(200)["pressure_psi"])
    assert not list(Path().glob("*.partial"))


def test_export_into_a_pipe(folder: Path) -> None:
    command = [sys.executable, "-m", "app", "export", str(folder.resolve()), "--csv", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "CI": "true"})
    assert done.stdout.count("\n") == 201 and done.stderr == ""


def test_export_of_a_crashed_run_says_what_is_missing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / STOP).unlink()
    assert lostmotion(["export", str(folder), "--csv", "out.csv"]) == 0
    assert "no stop document" in capsys.readouterr().err


def test_note_is_kept_and_shown(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert lostmotion(["note", "latest", "stem", "was", "greased"]) == 0
    assert lostmotion(["show", "latest"]) == 0
    assert "after the end: note: stem was greased" in capsys.readouterr().out


def test_view_without_a_screen_writes_the_file_and_says_what_to_do(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    assert lostmotion(["view", "latest"]) == 0
    assert "There is no screen here" in capsys.readouterr().out and (folder / VIEW).stat().st_size > 1000
    assert lostmotion(["view", "rerun+http://127.0.0.1:4321/proxy"]) == 2
    assert "ssh -L 4321:127.0.0.1:4321" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["show", "nothing"],
        ["export", "latest"],
        ["export", "latest", "--csv", "none/out.csv"],
        ["export", "broken.csv", "--csv", "out.csv"],
        ["note", "latest", " "],
        ["note", "broken.csv", "text"],
        ["view", "broken.csv"],
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_two(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    Path("broken.csv").write_text("time_s,command_psi,position_in\n0,3,0\n-1,3,0\n")
    assert lostmotion(arguments) == 2
    said = capsys.readouterr().err
    assert said and "Traceback" not in said and not Path("out.csv").exists()


def test_a_finished_view_is_opened_as_it_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert lostmotion(["view", "latest", "--no-window"]) == 0
    view = folder / VIEW
    before = view.stat().st_mtime_ns
    capsys.readouterr()
    assert lostmotion(["view", str(view), "--no-window"]) == 0
    assert capsys.readouterr().out == f"view: {view}\n"
    assert view.stat().st_mtime_ns == before
    Path("none.rrd").write_text("time_s,command_psi\n", encoding="utf-8")
    for words, sentence in ((["none.rrd"], "is no rerun file"), (["missing.rrd"], "cannot be read"),
                            ([str(view), "--rrd", "x.rrd"], "is a finished view")):  # fmt: skip
        assert lostmotion(["view", *words]) == 2
        assert sentence in capsys.readouterr().err
