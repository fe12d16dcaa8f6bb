"""`lostmotion simulate` from file to file."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from app.cli import run
from control.design import DesignModel, save_design

HEADER = "time_s,command_psi,position_in,target_in"


def write_inputs(folder: Path, effects: dict[str, dict[str, float | str]] | None = None) -> tuple[str, str, str]:
    """A model, a record of a resting valve that is told to close, and where the answer goes."""
    save_design(DesignModel(effects=effects or {}), folder / "model.toml")
    time_s = np.arange(200) * 0.1
    command = np.where(time_s > 1.0, 11.0, 5.0)
    rows = np.c_[time_s, command, np.zeros(200), np.full(200, 0.3)]
    np.savetxt(folder / "run.csv", rows, delimiter=",", header=HEADER, comments="")
    return str(folder / "model.toml"), str(folder / "run.csv"), str(folder / "out.csv")


def test_same_columns_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, record, out = write_inputs(tmp_path)
    assert run(["simulate", model, record, "--out", out]) == 0
    lines = Path(out).read_text().splitlines()
    assert lines[0] == "time_s,command_psi,pressure_psi,position_in,target_in"
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    assert values.shape == (200, 5)
    assert values[-1, 2] == pytest.approx(11.0)
    assert values[-1, 3] > 0.3  # the record says it did not move, the model says it did
    assert "RMS between model and record: position" in capsys.readouterr().out


def test_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, record, out = write_inputs(tmp_path, {"stiction": {"form": "one_jump", "breakaway": 9.0}})
    assert run(["simulate", model, record, "--out", out, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["position_rms"] == pytest.approx(0.0, abs=1e-12)  # it sticks, as recorded
    assert answer["pressure_rms"] is None
    assert answer["rows"] == 200
    assert answer["fit_percent"] is None  # nothing varies in a record of a stem at rest


def test_the_fit_is_printed_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, record, out = write_inputs(tmp_path)
    assert run(["simulate", model, record, "--out", out]) == 0
    capsys.readouterr()
    own, again = str(tmp_path / "own.csv"), Path(out).rename(tmp_path / "again.csv")  # the model's own readings
    assert run(["simulate", model, str(again), "--out", own, "--plot", str(tmp_path / "p.png"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["fit_percent"] == pytest.approx(100.0, abs=0.01)
    assert run(["simulate", model, str(again), "--out", own]) == 0
    assert "% of travel, fit 100.00 %)" in capsys.readouterr().out
    assert (tmp_path / "p.png").stat().st_size > 10_000
    assert run(["simulate", model, record, "--out", out, "--plot", str(tmp_path / "no" / "p.png")]) == 2
    assert "there is no folder" in capsys.readouterr().err


def test_bad_model_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, record, out = write_inputs(tmp_path, {"gremlins": {"size": 1.0}})
    assert run(["simulate", model, record, "--out", out]) == 2
    assert "model.toml: [effects.gremlins]" in capsys.readouterr().err
    assert not Path(out).exists()


def test_unwritable_target(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, record, _ = write_inputs(tmp_path)
    assert run(["simulate", model, record, "--out", str(tmp_path / "no" / "out.csv")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_it_speaks_and_draws_in_the_units_of_the_model(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, record, out = write_inputs(tmp_path)
    model = tmp_path / "mm.toml"
    model.write_text(
        '[units]\npressure = "kPa"\nposition = "mm"\n[valve]\na1 = 60.5\na2 = 40.1\ncompliance = 0.7\ntravel = 14.3\n'
        "rate_limit = 3.0\ntau = 2.7\n"
    )
    canvases: list[Figure] = []
    monkeypatch.setattr("app.fit_picture._save", lambda canvas, _path: canvases.append(canvas))
    assert run(["simulate", str(model), record, "--out", out, "--plot", str(tmp_path / "p.png")]) == 0
    said = capsys.readouterr().out
    assert "closes from 60.5 and opens at 40.1 kPa, 0.7 mm/kPa" in said
    assert re.search(r"position \d+\.\d+ mm \(", said)
    upper = canvases[0].axes[0]
    assert upper.get_ylabel() == "position [mm]"
    modelled = np.genfromtxt(out, delimiter=",", names=True)["position_in"]
    assert upper.lines[1].get_ydata() == pytest.approx(25.4 * modelled)
