"""What `lostmotion diagnose` leaves in its folder: nothing of an earlier verdict, and after Ctrl-C what is known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import run
from tests.app.test_diagnose import columns_of, write
from tests.control.toy_valve import Toy, random_steps, record
from twin.files import FILES
from twin.search.search import Searcher

STALE = "of an earlier diagnosis"


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """The report and the view have tests of their own."""
    monkeypatch.setattr("twin.write.write_report", lambda *_: None)
    monkeypatch.setattr("twin.write.write_rrd", lambda *_: None)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> str:
    """200 s of the design's own valve at 5 Hz."""
    healthy = record(Toy(), np.arange(0.0, 200.0, 0.2), random_steps(200.0, 0.2), noise_p=0.02, noise_x=8e-4)
    return write(tmp_path_factory.mktemp("record") / "x.csv", columns_of(healthy))


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """A folder in which an earlier diagnosis and a record lie."""
    for name in (*FILES, "notes.txt"):
        (tmp_path / name).write_text(STALE)
    return tmp_path


def stale_in(out: Path) -> list[str]:
    return sorted(path.name for path in out.iterdir() if STALE in path.read_text(encoding="utf-8"))


def stopped(file: str, out: Path) -> dict[str, Any]:
    """Diagnoses what is interrupted on the way, and reads what is left."""
    assert run(["diagnose", file, "--out", str(out)]) == 130
    document: dict[str, Any] = json.loads((out / "diagnosis.json").read_text())
    return document


def stop(*arguments: Any, **_: Any) -> None:
    arguments[-1]("position: one cause", 0.4)
    raise KeyboardInterrupt


@pytest.mark.thorough
def test_nothing_of_an_earlier_diagnosis_stays(file: str, out: Path) -> None:
    assert run(["diagnose", file, "--out", str(out)]) == 0
    assert stale_in(out) == ["notes.txt"]
    found = json.loads((out / "diagnosis.json").read_text())
    assert (found["complete"], found["incomplete_because"], found["interrupted"]) == (True, None, False)


def test_control_c_leaves_what_is_known(
    file: str, out: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("twin.diagnose.judge", stop)
    found = stopped(file, out)
    assert found["statement"].startswith("Interrupted at position: one cause (40 %)")
    assert (found["complete"], found["incomplete_because"]) == (False, "interrupted at position: one cause (40 %)")
    assert "the verdict stands for no answer" in found["data_quality"][-1]["handled"]
    assert (found["causes"], found["gap"]["after"], found["interrupted"]) == ([], None, True)
    assert found["gap"]["before"] == pytest.approx(0.14, rel=0.2)
    assert stale_in(out) == ["notes.txt"]
    assert (out / "model.toml").is_file()
    assert not (out / "report.html").exists()
    assert "interrupted" in capsys.readouterr().err


@pytest.mark.parametrize(
    "where",
    ["cut_at_holes", "settled_timing", "late_commands", pytest.param("predict_reading", marks=pytest.mark.thorough)],
)
def test_control_c_early_or_late_leaves_the_gap_of_the_design(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    def at_once(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(f"twin.diagnose.{where}", at_once)
    found = stopped(file, tmp_path)
    assert found["interrupted"] is True
    assert found["gap"]["before"] == pytest.approx(0.14, rel=0.2)


def test_control_c_leaves_the_causes_that_were_tried_alone(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = Searcher._polished

    def interrupted(self: Searcher, fits: Any) -> Any:
        if self.channel.name == "position":
            raise KeyboardInterrupt
        return tried(self, fits)

    monkeypatch.setattr(Searcher, "_polished", interrupted)
    found = stopped(file, tmp_path)
    names = [line["name"] for line in found["ranking"]]
    assert {"stiction", "parameter:tau", "dead_time"} <= set(names)
    assert len(names) == len(set(names))
    chances = [line["probability"] for line in found["ranking"]]
    assert chances == sorted(chances, reverse=True)
    assert found["causes"] == []


@pytest.mark.thorough
def test_of_a_positioners_record_it_is_said_that_no_number_is_the_valves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`identify` refuses it; what a valve leaves undone with its positioner shows all the same."""
    command = np.repeat(np.random.default_rng(1).uniform(20.0, 80.0, 30), 40)
    position = command.copy()
    for row in range(1, command.size):
        position[row] = command[row] + (position[row - 1] - command[row]) * np.exp(-0.25)
    table = np.column_stack((np.arange(command.size), command, np.round(position, 1)))
    np.savetxt(tmp_path / "x.csv", table, delimiter=",", header="time_s,command_%,position_%", comments="")
    assert run(["diagnose", str(tmp_path / "x.csv"), "--out", str(tmp_path / "d")]) == 0
    assert "Mind: the position is the command, percent for percent" in capsys.readouterr().out
    notes = json.loads((tmp_path / "d" / "diagnosis.json").read_text())["data_quality"]
    assert any("no number is the valve's alone" in note["handled"] for note in notes)
