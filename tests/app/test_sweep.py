"""`lostmotion sweep` on the virtual valve: real frames over a pseudo-terminal, in stepped time."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

import pytest

from app.cli import run
from app.console import RunDisplay
from control.experiment_file import load_experiment
from control.loop import Progress
from logs.run import read_run

SHORT = ["--set", "low=8", "--set", "high=10", "--set", "step=1", "--set", "dwell_s=2", "--set", "conditioning_s=2"]


def sweep(*words: str) -> int:
    return run(["sweep", *words])


def test_a_sweep_is_announced_recorded_and_ends_safe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("staircase", *SHORT, "--out", str(tmp_path / "r"), "--note", "first", "--seed", "3") == 0
    said = capsys.readouterr().out
    assert "The valve will move" in said.splitlines()[0]
    assert "14 s, commands 4 to 13 psi" in said.splitlines()[0]
    recorded = read_run(tmp_path / "r")
    assert recorded.status == "success"
    assert "confirmed its safe state" in recorded.reason
    assert recorded.rows == 140
    assert recorded.start["experiment"]["low"] == 8  # type: ignore[index]
    assert recorded.start["note"] == "first"
    assert recorded.start["virtual"]["seed"] == 3  # type: ignore[index]
    assert recorded.start["calibration"] == "virtual-two-point"
    assert {"supply_psi", "temperature_c"} <= set(recorded.columns)
    assert recorded.columns["position_in"].max() > 0.1


def test_a_folder_that_holds_something_is_refused_before_the_bench_is_opened(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "thesis.txt").write_text("years of work", encoding="utf-8")
    assert sweep("hold", "--port", "/dev/absent", "--out", str(tmp_path)) == 2
    assert run(["run", "--controller", "p", "--targets", "0.1", "--port", "/dev/absent", "--out", str(tmp_path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("the folder is not empty, and a record is never overwritten") == 2


def test_the_same_seed_gives_the_same_record(tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert sweep("hold", "--set", "hold_s=3", "--set", "conditioning_s=1", "--out", str(tmp_path / name)) == 0
    one, other = (read_run(tmp_path / name).columns for name in ("a", "b"))
    assert (one["pressure_psi"] == other["pressure_psi"]).all()
    assert (one["position_in"] == other["position_in"]).all()


def test_a_dry_run_shows_and_touches_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("nested", "--dry-run", "--out", str(tmp_path / "r")) == 0
    said = capsys.readouterr().out
    assert "Nothing was moved" in said
    assert len(said.splitlines()) == 9
    assert not (tmp_path / "r").exists()
    assert sweep("nested", "--dry-run", "--json") == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["low"], facts["high"], facts["unit"]) == (4.0, 13.0, "psi")
    assert facts["samples"] == pytest.approx(facts["duration_s"] / facts["period_s"])


def test_a_dry_run_knows_what_the_bench_allows(capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("staircase", "--period", "0.005", "--dry-run") == 0, "the virtual valve has no bits on a wire"
    assert sweep("staircase", "--period", "0.005", "--dry-run", "--port", "x") == 2
    assert "0.005 s is too short" in capsys.readouterr().err
    assert sweep("staircase", "--period", "3", "--dry-run") == 2
    assert "3 s is too long: the watchdog of device 'bench'" in capsys.readouterr().err
    assert sweep("staircase", "--set", "high=25", "--dry-run") == 2
    assert "bench 'virtual' allows 0 to 20 psi" in capsys.readouterr().err
    assert sweep("staircase", "--out", "/proc/r", "--dry-run") == 2
    assert "--out /proc/r: no files can be written there" in capsys.readouterr().err


def test_a_file_is_written_and_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("staircase", *SHORT, "--write", str(tmp_path / "e.toml")) == 0
    assert load_experiment(tmp_path / "e.toml").duration_s == pytest.approx(14.0)
    capsys.readouterr()
    assert sweep(str(tmp_path / "e.toml"), "--set", "dwell_s=1", "--json", "--out", str(tmp_path / "r")) == 0
    outcome = json.loads(capsys.readouterr().out)
    assert outcome["rows"] == 100
    assert outcome["run"] == str(tmp_path / "r")


def test_ctrl_c_closes_the_record_and_the_sweep_can_be_gone_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(self: RunDisplay, where: Progress) -> None:
        if where.step == 1:
            os.kill(os.getpid(), signal.SIGINT)

    with monkeypatch.context() as patched:
        patched.setattr(RunDisplay, "show", interrupt)
        assert sweep("staircase", *SHORT, "--out", str(tmp_path / "a")) == 130
    assert f"--resume {tmp_path / 'a'}" in capsys.readouterr().err
    stopped = read_run(tmp_path / "a")
    assert (stopped.status, stopped.rows) == ("abort", 81)
    assert "Ctrl-C" in stopped.reason
    assert "confirmed its safe state" in stopped.reason
    assert sweep("--resume", str(tmp_path / "a"), "--out", str(tmp_path / "b")) == 0
    going_on = read_run(tmp_path / "b")
    assert going_on.start["continues"] == stopped.start["uuid"]
    assert sorted(set(going_on.columns["step"])) == [-1.0, 1.0, 2.0, 3.0]
    assert sweep("--resume", str(tmp_path / "b")) == 2
    assert "nothing to go on with" in capsys.readouterr().err


def test_the_positioner_is_swept_in_percent(tmp_path: Path) -> None:
    assert sweep("steps", "--physics", "positioner", "--set", "heights=1", "--set", "dwell_s=4",
                 "--set", "conditioning_s=1", "--out", str(tmp_path / "r")) == 0  # fmt: skip
    recorded = read_run(tmp_path / "r")
    assert recorded.units["command_percent"] == "percent"
    assert recorded.columns["next_command_percent"].max() == 100.0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["sawtooth"], "'sawtooth' does not exist; choose one of"),
        ([], "name an experiment kind or file"),
        (["hold", "--set", "at=25"], "commands 4 to 25 psi, bench 'virtual' allows 0 to 20 psi"),
        (["hold", "--set", "at=high"], "at = 'high' must be a finite number"),
        (["hold", "--set", "at"], "not of the form key=value"),
        (["hold", "--period", "0.0001"], "too short"),
        (["hold", "--period", "3"], "watchdog of device 'bench'"),
        (["hold", "--physics", "steam"], "no physics 'steam'"),
        (["hold", "--effect", "stiction"], "not of the form NAME=SIZE"),
        (["hold", "--profile", "nope"], "no profile 'nope'"),
        (["hold", "--port", "/dev/null", "--physics", "thesis"], "leave them out with --port"),
        (["absent.toml"], "absent.toml: the experiment cannot be read"),
        (["--resume", "absent"], "'absent' is neither a file nor a run"),
        (["staircase", "--resume", "absent"], "staircase and --resume exclude each other"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_2(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert sweep(*words) == 2
    error = capsys.readouterr().err.strip()
    assert sentence in error
    assert "Traceback" not in error
    assert not list(tmp_path.rglob("run.json"))


@pytest.mark.parametrize(("what", "kind"), [("base.csv", "file"), ("runs", "folder")])
def test_something_that_is_there_and_no_experiment_is_said_to_be_that(
    what: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "base.csv").write_text("time_s\n")
    (tmp_path / "runs").mkdir()
    (tmp_path / "steps").mkdir()  # a kind stays a kind
    assert run(["sweep", what]) == 2
    assert f"{what} is a {kind} but no experiment; sweep takes a kind (hold," in capsys.readouterr().err
    assert run(["sweep", "steps", "--dry-run"]) == 0
    assert run(["sweep", "steep"]) == 2
    assert "'steep' does not exist" in capsys.readouterr().err
