"""Every "Run it" of docs/thesis.md runs, over Modbus, and what it records is what the page was computed from."""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import app.hunting
import app.rivals
from app.cli import run
from app.gallery.if_then import LINE
from app.gallery.index import KEYS
from app.gallery.models import STEP
from logs.load import load_recording
from logs.run import read_run

PAGE = Path(__file__).parents[2] / "docs" / "thesis.md"
SECONDS = {"1-5", "1-6", "brake", "rivals"}  # that these take
FILES = ("RUN", "OTHER", "MODEL.toml", "FILE.csv", "FILE.png")
# The same with fewer ticks: the arguments are the page's, and what is given twice counts the second time.
SHORTER = {"sweep": ["--period", "1"], "run": ["--hold", "1.5"], "thesis": ["--json"]}


def lines() -> dict[str, str]:
    """The first command line of every "Run it", by the key of its item."""
    found = re.findall(
        r"^Run it: `([^`]+)`, `lostmotion thesis (\S+)`$", PAGE.read_text(encoding="utf-8"), re.MULTILINE
    )
    return {key: command for command, key in found}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("gallery")


@pytest.fixture(scope="module")
def done(folder: Path) -> dict[str, int]:
    """Commands that have run, with their files: the staircase and its model serve several items."""
    return {}


def test_every_line_was_found() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert len(lines()) == text.count("Run it:") > 12
    assert set(lines()) <= set(KEYS)
    diagrams = {"2-3", "2-6", "3-1", "3-6", "3-9"}
    assert set(KEYS) - set(lines()) <= diagrams


@pytest.mark.parametrize("key", [pytest.param(k, marks=pytest.mark.thorough if k in SECONDS else ()) for k in lines()])
def test_a_line_runs_to_its_end(
    key: str, folder: Path, done: dict[str, int], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    everything = app.rivals.run_all
    monkeypatch.setattr(app.rivals, "run_all", lambda todo, processes: everything(todo[:1], 1))  # of hundreds
    monkeypatch.setattr(app.hunting, "study", partial(app.hunting.study, duration_s=30.0))  # of 1200
    monkeypatch.chdir(folder)
    for part in lines()[key].split(" && "):
        program, verb, *words = shlex.split(part)
        assert program == "lostmotion"
        if part in done:
            continue
        if "OTHER" in words and verb == "sweep":
            _clear(folder / "OTHER")
        elif verb in ("sweep", "run") and "--out" not in words:
            words += ["--out", f"record-{key}"]
        assert run([verb, *words, *SHORTER.get(verb, [])]) == 0, capsys.readouterr().err
        done |= {part: 0} if "OTHER" not in words else {}
    recorded = folder / f"record-{key}"
    if recorded.exists():
        assert read_run(recorded).status == "success"


def _clear(path: Path) -> None:
    from shutil import rmtree

    rmtree(path, ignore_errors=True)


def test_a_closed_loop_over_the_wire_does_what_the_trial_of_the_page_does(tmp_path: Path) -> None:
    """The noise is another, because a device is read more often than a plant; the holds end in the same places."""
    short = replace(LINE, hold_s=60.0, steps=(50.0, 75.0, 50.0))
    assert run([*shlex.split(short.command(seed=3))[1:], "--out", str(tmp_path / "r"), "--json"]) == 0
    wire, trace = read_run(tmp_path / "r").columns["position_in"], short.trial(seed=3).position_in
    ends = [each.reshape(3, -1)[:, -150:].mean(axis=1) for each in (wire, trace)]
    assert ends[0] == pytest.approx(ends[1], abs=0.005 * 0.5625)
    assert ends[0][2] - 0.28125 > 0.01  # the error after opening that the item is about


def test_a_sweep_over_the_wire_is_the_record_of_the_page_but_for_noise(tmp_path: Path) -> None:
    assert run([*shlex.split(STEP.command(seed=3, out=str(tmp_path / "r")))[1:], "--json"]) == 0
    wire, record = load_recording(tmp_path / "r"), STEP.record(seed=3)
    assert np.array_equal(wire.command, record.command)
    assert np.sqrt(np.mean((wire.position - record.position) ** 2)) < 1e-3  # a tick aside it is 1.2e-3
