"""`lostmotion run`: closed loops on the virtual valve."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest

from app.cli import run
from app.console import RunDisplay
from control.controller import controller_names, make_controller
from control.design import DesignModel, save_design
from control.loop import Progress
from hal.profile import FOLDER
from hal.sample import Reading, Sample
from logs.run import read_run


def close(*words: str) -> int:
    return run(["run", *words])


def test_brake_reckons_with_the_slew_of_the_bench(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """All profiles of real modules allow 20 psi/s; told nothing of it, it took 15 to 23 s to settle."""
    words = ["--controller", "brake", "--targets", "0.1,0.4,0.25,0.3", "--hold", "20", "--out", str(tmp_path / "r")]
    profile = tmp_path / "mine.toml"
    text = (FOLDER / "virtual.toml").read_text(encoding="utf-8")
    profile.write_text(text.replace("slew_per_s = 2000.0", "slew_per_s = 20.0"), encoding="utf-8")
    assert close(*words, "--profile", str(profile), "--json") == 0
    said = capsys.readouterr()
    targets = json.loads(said.out)["targets"]
    assert all(abs(each["final_error_in"]) < 0.003 * 0.5625 for each in targets)
    assert all(each["settled_s"] is not None and each["settled_s"] < 6.0 for each in targets)
    assert "held to the limits" not in said.err
    controller = read_run(tmp_path / "r").start["controller"]
    assert controller["settings"]["slew_psi_per_s"] == 19.0  # type: ignore[index]


def test_commands_that_the_bench_does_not_follow_are_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A controller knows nothing of the slew that a bench allows."""
    profile = tmp_path / "slow.toml"
    text = (FOLDER / "virtual.toml").read_text(encoding="utf-8")
    profile.write_text(text.replace("slew_per_s = 2000.0", "slew_per_s = 2.0"), encoding="utf-8")
    words = ["--controller", "overdrive", "--targets", "0.3", "--hold", "10", "--out", str(tmp_path / "r")]
    assert close(*words, "--profile", str(profile)) == 0
    assert "were held to the limits of the bench, its range and its slew of 2 psi/s" in capsys.readouterr().err
    assert any("were held to the limits" in event.text for event in read_run(tmp_path / "r").events)
    words[-1] = str(tmp_path / "fast")
    assert close(*words) == 0
    assert "held to the limits" not in capsys.readouterr().err


def test_a_loop_is_closed_recorded_and_judged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--controller", "if_then_pi", "--targets", "0.3,0.1", "--hold", "40", "--out", str(tmp_path / "r")]
    assert close(*words, "--json") == 0
    result = json.loads(capsys.readouterr().out)
    assert [target["target_in"] for target in result["targets"]] == [0.3, 0.1]
    assert result["worst_final_error_percent"] < 5.0
    recorded = read_run(tmp_path / "r")
    assert recorded.status == "success"
    assert recorded.start["controller"]["name"] == "if_then_pi"  # type: ignore[index]
    assert recorded.start["design"]["a1"] == 8.78  # type: ignore[index]
    assert recorded.rows == 800


def test_a_stopped_loop_is_gone_on_with_at_the_target_it_did_not_finish(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(self: RunDisplay, where: Progress) -> None:
        if where.step == 1:
            os.kill(os.getpid(), signal.SIGINT)

    first, rest, model = str(tmp_path / "a"), str(tmp_path / "b"), str(tmp_path / "model.toml")
    save_design(DesignModel(), Path(model))
    words = ["--controller", "pi", "--set", "ki=0.7", "--targets", "0.1,0.2,0.3", "--hold", "4", "--period", "0.2"]
    with monkeypatch.context() as patched:
        patched.setattr(RunDisplay, "show", interrupt)
        assert close(*words, "--out", first, "--seed", "4", "--effect", "stiction=0.1", "--twin", model) == 130
    said = capsys.readouterr().err
    assert f"stopped after 21 samples; record: {first}\n" in said
    assert said.endswith("lostmotion: interrupted; the valve is at its safe command\n")
    assert f"go on with: lostmotion run --resume {first} --twin {model} --seed 4 --effect stiction=0.1\n" in said
    stopped = read_run(tmp_path / "a")
    assert (stopped.status, stopped.rows) == ("abort", 21)
    assert close("--resume", first, "--dry-run") == 0
    assert "2 targets (0.2, 0.3 in), 8 s, a tick every 0.2 s" in capsys.readouterr().out
    assert close("--resume", first, "--out", rest, "--json") == 0
    assert [target["target_in"] for target in json.loads(capsys.readouterr().out)["targets"]] == [0.2, 0.3]
    going_on = read_run(tmp_path / "b")
    assert going_on.start["continues"] == stopped.start["uuid"]
    for key in ("controller", "design", "targets_in", "hold_s", "period_s"):
        assert going_on.start[key] == stopped.start[key]
    assert sorted(set(going_on.columns["step"])) == [1.0, 2.0]


def test_what_cannot_be_gone_on_with_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = str(tmp_path / "r")
    assert close("--controller", "p", "--targets", "0.1", "--hold", "1", "--out", done) == 0
    assert close("--resume", done) == 2
    assert "this run is complete" in capsys.readouterr().err
    assert close("--resume", done, "--hold", "3", "--set", "kp=1") == 2
    assert "--resume takes --hold, --set from the record of that run; leave it out" in capsys.readouterr().err
    assert run(["sweep", "--resume", done]) == 2
    assert "not a 'sweep' but a 'run'; try `lostmotion run --resume`" in capsys.readouterr().err


def test_the_record_replays_bit_for_bit(tmp_path: Path) -> None:
    words = ["--controller", "pi", "--targets", "0.2", "--hold", "10", "--set", "ki=0.7", "--out", str(tmp_path / "r")]
    assert close(*words) == 0
    recorded = read_run(tmp_path / "r")
    told = recorded.start["controller"]
    assert isinstance(told, dict)
    controller = make_controller(told["name"], DesignModel(), **told["settings"])
    columns = recorded.columns
    state, commands = None, []
    for i in range(recorded.rows - 1):
        t = columns["time_s"][i]
        sample = Sample(
            t,
            float(columns["next_command_psi"][i]),
            Reading(float(columns["position_in"][i]), t, 0.0),
            Reading(float(columns["pressure_psi"][i]), t, 0.0),
        )
        state = controller.initial(sample, 0.2) if state is None else state
        state, command = controller.step(state, sample, 0.2, 0.1)
        commands.append(np.float32(command))  # the command register of the default profile holds a float32
    assert np.array_equal(columns["next_command_psi"][1:].astype(np.float32), np.array(commands))


def test_the_table_is_readable_in_a_pipe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert close("--controller", "open_loop", "--targets", "0.1", "--hold", "3", "--out", str(tmp_path / "r")) == 0
    said = capsys.readouterr().out
    assert "The valve will move" in said
    assert "at its safe command; record:" in said
    assert said.count("[in]") == 3
    assert "\x1b[" not in said


def test_controllers_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert close("--list", "--json") == 0
    assert set(json.loads(capsys.readouterr().out)) == set(controller_names())


def test_a_dry_run_touches_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert close("--controller", "p", "--targets", "0.1,0.2", "--dry-run", "--out", str(tmp_path / "r")) == 0
    assert "2 targets (0.1, 0.2 in), 2 min 00 s" in capsys.readouterr().out
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--period", "0.0001"], "0.0001 s is too short: the wire of bench 'virtual' needs 0.0005556 s for a tick"),
        (["--period", "0.005", "--port", "x"], "0.005 s is too short: the wire of bench 'virtual' needs 0.008302 s"),
        (["--period", "3"], "3 s is too long: the watchdog of device 'bench' vents the valve after 2 s of silence"),
        (["--period", "nan"], "--period nan s must be above 0, and finite"),
        (["--profile", "positioner"], "takes percent"),
        (["--twin", "absent.toml"], "--twin absent.toml: the design model cannot be read"),
        (["--out", "/proc/r"], "--out /proc/r: no files can be written there"),
    ],
)
def test_a_dry_run_is_refused_as_the_run_would_be(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert close("--controller", "p", "--targets", "0.1", "--dry-run", *words) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--controller", "magic", "--targets", "0.1"], "'magic' does not exist"),
        (["--controller", "p"], "give a controller and targets"),
        (["--controller", "p", "--targets", "0.1,x"], "'x' is not a position"),
        (["--controller", "p", "--targets", "0.1,0.9"], "target 2 is 0.9 in; the valve travels from 0 to 0.5625 in"),
        (["--controller", "p", "--targets", "0.1", "--hold", "0"], "above 0"),
        (["--controller", "p", "--targets", "0.1", "--set", "kd=1"], "no setting 'kd'"),
        (["--controller", "p", "--targets", "0.1", "--design", "absent.toml"], "absent.toml"),
        (["--controller", "p", "--targets", "0.1", "--profile", "positioner"], "takes percent"),
        (["--controller", "p", "--targets", "0.1", "--physics", "positioner"], "takes percent"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_2(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert close(*words) == 2
    assert sentence in capsys.readouterr().err
    assert not list(tmp_path.rglob("run.json"))


def test_a_port_that_is_not_there_fails_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert close("--controller", "p", "--targets", "0.1", "--port", "/dev/absent") == 1
    assert "/dev/absent" in capsys.readouterr().err
