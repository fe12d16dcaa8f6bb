"""`lostmotion explain`: the list, one effect, JSON, and what cannot be explained."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli import run
from control.design import DesignModel
from twin.fit.numbers import NUMBERS, nominal
from twin.model.catalog import effect, effects


def test_list_names_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain"]) == 0
    words = capsys.readouterr().out.split()
    assert set(effects()) <= set(words)


def test_one_effect(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run(["explain", "distributed_hysteresis", "--form", "uniform", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "source: Kuhnen" in out
    assert "spread [psi] 0 to 1.48" in out
    assert "reading (up) over pressure (right), nested" in out
    assert {path.suffix for path in tmp_path.iterdir()} == {".svg", ".png"}


def test_an_effect_of_chance_has_no_trajectory(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain", "sensor_dropouts"]) == 0
    assert "single readings by chance" in capsys.readouterr().out


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain", "creep", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["stage"] == "actuator"
    assert set(facts["forms"]) == {form.name for form in effect("creep").forms}
    assert facts["experiments"][0]["beyond_retuning_percent_of_travel"] > 0.5


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["gremlins"], "no effect is called 'gremlins'"),
        (["creep", "--form", "fast"], "effect creep has no form 'fast'; it has one_tail"),
        (["creep", "--experiment", "dance"], "choose one of staircase"),
    ],
)
def test_bad_input(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain", *words]) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize("name", sorted(NUMBERS))
def test_a_number_of_the_design_is_explained_as_verdicts_name_it(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["explain", f"parameter:{name}", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["name"], facts["stage"]) == (f"parameter:{name}", NUMBERS[name])
    assert facts["default"] == pytest.approx(nominal(DesignModel(), name))
    assert run(["explain", f"parameter:{name}"]) == 0
    assert facts["claim"] in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [(["parameter:mass"], "there are deadband"), (["parameter:tau", "--form", "x"], "are for effects")],
)
def test_what_is_no_number_or_not_of_one_is_refused(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["explain", *words]) == 2
    assert sentence in capsys.readouterr().err
