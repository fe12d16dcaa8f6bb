"""`lostmotion identify`: the truth test over Modbus, and foreign files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.cli import run
from control.design import load_design
from control.identify import default_design
from control.identify_checks import told_positions
from logs.recording import Recording
from tests.control.toy_valve import Toy, random_steps, record
from twin.model.model_units import in_units_of

TRUTH = {"a1": 8.78, "a2": 5.82, "compliance": 0.19, "tau": 2.7, "rate_limit": 0.12, "travel": 0.5625, "ep.tau": 0.3}


@pytest.fixture(scope="module")
def staircase(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "staircase"
    assert run(["sweep", "staircase", "--set", "step=0.3", "--set", "dwell_s=12", "--out", str(folder), "--json"]) == 0
    return folder


def test_a_sweep_over_modbus_gives_the_truth(
    staircase: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert run(["identify", str(staircase), "--out", str(tmp_path / "m.toml"), "--json"]) == 0
    estimates = json.loads(capsys.readouterr().out)["estimates"]
    held = 0
    for name, value in TRUTH.items():
        assert estimates[name]["value"] == pytest.approx(value, rel=0.01), name
        low, high = estimates[name]["ci95"]
        held += low <= value <= high
    assert held >= 5
    assert estimates["a1 (curves)"]["value"] == pytest.approx(8.78, abs=0.02)
    assert estimates["a2 (curves)"]["value"] == pytest.approx(5.82, abs=0.02)
    assert estimates["tau (63 %)"]["value"] == pytest.approx(2.7, rel=0.03)
    assert estimates["tau (63 %)"]["ci95"][0] <= 2.7 <= estimates["tau (63 %)"]["ci95"][1]
    design = load_design(tmp_path / "m.toml")
    assert (design.a1, design.a2, design.tau_s) == pytest.approx((8.78, 5.82, 2.7), rel=0.01)


def test_the_table_shows_values_intervals_and_where_the_model_is(
    staircase: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["identify", str(staircase), "--out", str(tmp_path / "m.toml")]) == 0
    said = capsys.readouterr().out
    for word in (*TRUTH, "k_eq", "63 % rule", "95 % interval", "% of travel", "m.toml"):
        assert word in said
    assert (tmp_path / "m.toml").read_text(encoding="utf-8").startswith("# identified from staircase")


def test_a_strangers_csv_in_its_own_units(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time_s = np.arange(0.0, 240.0, 0.25)
    toy = record(Toy(), time_s, random_steps(240.0, 0.25))
    assert toy.pressure is not None
    table = np.column_stack((time_s * 1e3, toy.command * 6.894757, toy.pressure * 6.894757, toy.position * 25.4))
    np.savetxt(tmp_path / "x.csv", table, delimiter=",", header="t,u,p,x", comments="")
    words = ["--map", "time=t,command=u,pressure=p,position=x", "--units", "time=ms,command=kPa,position=mm"]
    assert run(["identify", str(tmp_path / "x.csv"), "--out", str(tmp_path / "m.toml"), *words]) == 0
    given = load_design(tmp_path / "m.toml")
    assert (given.pressure_unit, given.position_unit) == ("kPa", "mm")
    design = in_units_of(given, "psi", "in")
    assert (design.a1, design.a2, design.compliance) == pytest.approx((8.78, 5.82, 0.19), rel=0.01)
    assert "mm/kPa" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (["absent.csv", "--out", "m.toml"], 2, "absent.csv"),
        (["x.csv", "--out", "m.json"], 2, "ends in .toml"),
        (["still.csv", "--out", "m.toml"], 2, "command never changes"),
        (["stuck.csv", "--out", "m.toml"], 2, "position never leaves its noise"),
    ],
)
def test_bad_input_is_one_sentence(
    words: list[str],
    code: int,
    sentence: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    rows = [f"{0.1 * i:.1f},9,9,0.{i % 7}" for i in range(100)]
    Path("still.csv").write_text("time_s,command_psi,pressure_psi,position_in\n" + "\n".join(rows) + "\n")
    rows = [f"{0.1 * i:.1f},{5 + i % 60 // 10},0.3" for i in range(400)]
    Path("stuck.csv").write_text("time_s,command_psi,position_in\n" + "\n".join(rows) + "\n")
    assert run(["identify", *words]) == code
    assert sentence in capsys.readouterr().err
    assert not Path("m.toml").exists()


def test_record_model_and_what_is_left_are_drawn(staircase: Path, tmp_path: Path) -> None:
    picture = tmp_path / "fit.svg"
    words = [str(staircase), "--out", str(tmp_path / "m.toml"), "--json"]
    assert run(["identify", *words, "--plot", str(picture)]) == 0
    assert picture.stat().st_size > 10_000
    assert run(["identify", *words, "--plot", str(tmp_path / "fit.docx")]) == 2


def test_a_positioners_record_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = str(tmp_path / "r")
    short = ["--set", "step=25", "--set", "dwell_s=5", "--set", "conditioning_s=5"]
    assert run(["sweep", "staircase", "--physics", "positioner", *short, "--out", record]) == 0
    assert run(["identify", record, "--out", str(tmp_path / "m.toml")]) == 2
    assert "positions for a positioner" in capsys.readouterr().err
    assert not (tmp_path / "m.toml").exists()


@pytest.mark.thorough
def test_a_strangers_record_of_a_positioner_is_refused_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file does not say that its commands are positions; that the stem goes where it is told does."""
    levels = np.random.default_rng(1).uniform(20.0, 80.0, 30)
    command = np.repeat(levels, 40)
    position = command.copy()
    for row in range(1, command.size):
        position[row] = command[row] + (position[row - 1] - command[row]) * np.exp(-0.25)
    table = np.column_stack((np.arange(command.size), command, np.round(position, 1)))
    np.savetxt(tmp_path / "x.csv", table, delimiter=",", header="time_s,command_%,position_%", comments="")
    assert run(["identify", str(tmp_path / "x.csv"), "--out", str(tmp_path / "m.toml")]) == 2
    assert "so the commands are positions for a positioner" in capsys.readouterr().err
    assert not (tmp_path / "m.toml").exists()


def test_what_a_positioner_was_told_shows_without_a_pressure_only() -> None:
    one_to_one = replace(default_design("percent", "percent"), a1=0.4, a2=-0.3, compliance=0.99)
    blind = Recording("x", np.arange(3.0), np.zeros(3), np.zeros(3), None, "percent", "percent")
    assert told_positions(one_to_one, [blind])
    assert not told_positions(one_to_one, [replace(blind, pressure=np.zeros(3))])
    assert not told_positions(replace(one_to_one, a1=9.0), [blind])
    assert not told_positions(replace(one_to_one, compliance=0.8), [blind])
    assert not told_positions(replace(one_to_one, position_unit="mm"), [blind])
