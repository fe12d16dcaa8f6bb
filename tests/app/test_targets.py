"""Where a verb may write: never over what it reads or what was recorded, and said before any work is done."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from app.cli import run
from app.targets import check_apart, check_file, check_folder
from control.design import DesignModel, save_design
from hal.errors import BadInput
from logs.layout import SAMPLES, START

ROWS = "time_s,command_psi,position_in\n" + "".join(
    f"{0.1 * k:.1f},{5 + k % 9},{0.01 * (k % 7):.2f}\n" for k in range(60)
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A design, a recording, links to it, and an experiment."""
    monkeypatch.chdir(tmp_path)
    save_design(DesignModel(), tmp_path / "model.toml")
    (tmp_path / "base.csv").write_text(ROWS)
    (tmp_path / "link.csv").symlink_to(tmp_path / "base.csv")
    os.link(tmp_path / "base.csv", tmp_path / "hard.csv")
    (tmp_path / "model.svg").symlink_to(tmp_path / "model.toml")
    (tmp_path / "x.csv").mkdir()
    assert run(["sweep", "steps", "--write", "steps.toml"]) == 0
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()} | {
        str(path): b"" for path in folder.rglob("*") if path.is_dir()
    }


OVER_AN_INPUT = [
    "simulate model.toml base.csv --out base.csv",
    "simulate model.toml base.csv --out ./x.csv/../base.csv",
    "simulate model.toml base.csv --out link.csv",
    "simulate model.toml base.csv --out hard.csv",
    "simulate model.toml base.csv --out model.toml",
    "simulate model.toml base.csv --out o.csv --plot model.svg",
    "export base.csv --csv base.csv",
    "export base.csv --parquet link.csv",
    "identify base.csv model.toml --out model.toml",
    "identify base.csv model.toml --out o.toml --plot model.svg",
    "diagnose base.csv --design model.toml --out .",
    "compare --design model.toml --plot model.svg",
    "analyse --design model.toml --csv model.toml",
    "analyse --design model.toml --plot model.svg",
    "view base.csv --no-window --rrd base.csv",
    "view base.csv --headless-png base.csv",
    "sweep steps.toml --set period_s=0.2 --write steps.toml",
]


@pytest.mark.parametrize("words", OVER_AN_INPUT)
def test_an_input_is_never_overwritten(words: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = contents(folder)
    assert run(words.split()) == 2
    assert "an input is never overwritten" in capsys.readouterr().err
    assert contents(folder) == before


NO_USE = [
    "diagnose base.csv --out base.csv",
    "diagnose base.csv --out base.csv/sub",
    "diagnose base.csv --design no.toml --out new",
    "diagnose base.csv --design base.csv --out new/deep",
    "diagnose none.csv --out new",
    "simulate model.toml base.csv --out x.csv",
    "simulate model.toml base.csv --out base.csv/o.csv",
    "simulate model.toml base.csv --out o.png --plot o.png",
    "identify base.csv --out base.csv/o.toml",
    "export base.csv --csv x.csv",
    "export base.csv --csv o.csv --parquet ./o.csv",
    "calibrate --port /no/port --out base.csv",
    "calibrate --port /no/port --out base.csv/p.toml",
    "explain stiction --out base.csv",
    "blind --trials 1 --out base.csv/sub",
    "demo --out base.csv/sub",
    "thesis 1-2 --plot base.csv/sub",
    "gallery 1-2 --out base.csv/sub",
    "sweep steps --out base.csv/sub",
    "sweep steps --write base.csv/o.toml",
    "view base.csv --no-window --rrd base.csv/o.rrd",
]
if sys.platform == "linux":
    NO_USE += ["diagnose base.csv --out /proc/xx", "blind --trials 1 --out /proc/xx", "sweep steps --out /proc/xx"]


@pytest.mark.parametrize("words", NO_USE)
def test_what_cannot_be_used_is_one_sentence_and_leaves_nothing(
    words: str, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for work in (
        "twin.diagnose.diagnose",
        "app.blind.pool.run_all",
        "app.session.open_bench",
        "twin.explain.signature",
    ):
        monkeypatch.setattr(work, None)  # refused before any of it
    before = contents(folder)
    assert run(words.split()) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "defect" not in told
    assert contents(folder) == before


@pytest.mark.parametrize("name", [START, SAMPLES])
def test_a_recorded_run_is_never_overwritten(name: str, tmp_path: Path) -> None:
    (tmp_path / START).write_text("{}")
    (tmp_path / SAMPLES).write_bytes(b"")
    with pytest.raises(BadInput, match="part of a recorded run"):
        check_file("--out", tmp_path / name)
    check_file("--out", tmp_path / "export.csv")
    check_folder("--out", tmp_path, writes=["diagnosis.json"])


def test_what_can_be_used_is_left_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "old.csv").write_text("old")
    check_file("--out", tmp_path / "old.csv", [tmp_path / "other.csv", None])
    check_file("--out", tmp_path / "a" / "b" / "new.toml", parents=True)
    check_folder("--out", tmp_path / "c" / "d")
    check_apart({"--out": tmp_path / "o", "--plot": None, "--csv": tmp_path / "p"})
    assert contents(tmp_path) == {str(tmp_path / "old.csv"): b"old"}
