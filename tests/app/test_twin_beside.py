"""`run --twin`: the model's columns are in the record, and a valve that is not its model is noticed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from app.cli import cli
from app.commands.run import command as run_verb
from control.design import DesignModel, save_design
from hal.errors import BadInput
from logs.run import Run, read_run


def run_beside(model: DesignModel, folder: Path) -> tuple[Result, Run]:
    save_design(model, folder / "model.toml")
    words = ["run", "--controller", "overdrive", "--targets", "0.1,0.4", "--hold", "25"]
    words += ["--twin", str(folder / "model.toml"), "--out", str(folder / "run")]
    said = CliRunner().invoke(cli, words)
    assert said.exit_code == 0, said.output
    return said, read_run(folder / "run")


def test_records_prediction_residual_and_statistic(tmp_path: Path) -> None:
    said, run = run_beside(DesignModel(), tmp_path)
    assert "left its model" not in said.output
    residual = run.columns["twin_residual_in"]
    assert run.units["twin_residual_in"] == "in"
    assert np.allclose(residual, run.columns["position_in"] - run.columns["twin_position_in"], equal_nan=True)
    assert 100.0 * np.nanstd(residual) / 0.5625 < 0.3
    assert np.nanmax(np.abs(run.columns["twin_cusum"])) < 1.0
    twin = run.start["twin"]
    assert isinstance(twin, dict)
    assert twin["model"] == "model.toml"
    assert twin["false_alarm_s"] == pytest.approx(360_000.0)


def test_warns_when_the_valve_is_not_its_model(tmp_path: Path) -> None:
    said, run = run_beside(replace(DesignModel(), a1=8.4, a2=5.4), tmp_path)
    assert "warning: twin: the valve has left its model" in said.output
    assert np.nanmax(np.abs(run.columns["twin_cusum"])) >= 1.0
    assert any("left its model" in event.text and event.level == "warning" for event in run.events)


def test_a_model_that_cannot_be_read_is_said_before_anything_moves(tmp_path: Path) -> None:
    words = ["--controller", "pi", "--targets", "0.1", "--out", str(tmp_path / "run")]
    with pytest.raises(BadInput, match=r"--twin .*missing.toml: the design model cannot be read"):
        run_verb.main([*words, "--twin", str(tmp_path / "missing.toml")], standalone_mode=False)
    (tmp_path / "odd.toml").write_text(
        "[valve]\na1=8.78\na2=5.82\ncompliance=0.19\ntau=2.7\nrate_limit=0.12\ntravel=0.56\n[effects.magic]\nx=1.0\n",
        encoding="utf-8",
    )
    with pytest.raises(BadInput, match="no effect is called 'magic'"):
        run_verb.main([*words, "--twin", str(tmp_path / "odd.toml")], standalone_mode=False)
    assert not (tmp_path / "run").exists()


def test_a_model_in_percent_is_refused_with_what_can_be_done_on_a_bench(tmp_path: Path) -> None:
    save_design(replace(DesignModel(), pressure_unit="percent"), tmp_path / "percent.toml")
    words = ["--controller", "pi", "--targets", "0.1", "--out", str(tmp_path / "run")]
    with pytest.raises(BadInput, match="identify a model from a record of this bench") as caught:
        run_verb.main([*words, "--twin", str(tmp_path / "percent.toml")], standalone_mode=False)
    assert "--units" not in str(caught.value)
    assert not (tmp_path / "run").exists()
