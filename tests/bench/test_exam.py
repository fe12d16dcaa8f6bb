"""A sealed folder of somebody else's is answered before its labels are opened, and scored by the names."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench import exam
from bench.exam_claims import read
from bench.exam_score import Answer, claims, label_of, text
from control.design import DesignModel, save_design
from hal.errors import BadInput
from logs.recording import Recording
from twin.model.catalog import effect
from twin.model.model_units import in_units_of
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording

GAP = {"before": 2.0, "retuned": 1.5, "after": 0.2, "noise_floor": 0.2}


def answer(cls: str, truth: list[str], verdict: str, *named: tuple[str, str, float], **more) -> Answer:
    """An answer that names causes as (name, stage, probability)."""
    causes = [{"name": n, "stage": stage, "probability": p} for n, stage, p in named]
    said = {"verdict": verdict, "causes": causes, "confusable": [], "ranking": [], "gap": GAP, "seconds": 9.0}
    return Answer(
        "case01", label_of("case01", {"cls": cls, "truth": truth}), said | {"where": {"stage": None}} | more, 0.5
    )


CREEP, DRIFT = ("creep", "actuator", 0.97), ("lvdt_drift", "sensor", 0.6)
ANSWERS = [
    answer("healthy", [], "no_gap"),
    answer("healthy", [], "effect", DRIFT),
    answer("number", ["parameter:ep_tau"], "parameter", ("parameter:ep_tau", "ep", 0.97)),
    answer("single", ["creep"], "effect", CREEP, unseen={"before_in": 0.01, "after_in": 0.001}),
    answer("single", ["stiction"], "effect", CREEP, confusable=[["creep", "stiction"]]),
    answer("pair", ["creep", "lvdt_drift"], "effects", CREEP, DRIFT),
    answer("pair", ["creep", "stiction"], "effects", CREEP, DRIFT),
    answer("outsider", ["outsider:bent_rod"], "unexplained"),
    answer("outsider", ["outsider:bent_rod"], "effect", CREEP),
]


def test_counts_are_strictly_by_the_names() -> None:
    said = text(ANSWERS)
    assert "| 9 | 5 of 9 | 1 of 2 | 4 of 5 | 5 of 5 | 1 of 2 | 1 of 2 | 1.14 |" in said
    assert "true of those said with 0.96 or more: 4 of 6" in said
    assert "closure on an unseen record: median 0.9900" in said


def test_what_the_design_misses_by_less_than_the_floor_has_no_closure() -> None:
    """The floor is a share of the design's own travel: 0.2 % of 0.5 in."""
    unseen = [{"before_in": before_in, "after_in": 0.0} for before_in in (0.00099, 0.00101)]
    found = [answer("single", ["creep"], "effect", CREEP, unseen=one).closure for one in unseen]
    assert found == [None, 1.0]
    assert answer("healthy", [], "no_gap", unseen=unseen[1]).closure is None


def test_without_a_single_answer_the_errors_are_told() -> None:
    assert "row 3: no number" in text([answer("single", ["creep"], "", error="case.csv: row 3: no number")])


def test_what_ended_in_an_error_claims_nothing() -> None:
    broken = Answer("case01", label_of("case01", {"cls": "single", "truth": ["creep"]}), {"error": "no number"}, 0.5)
    assert claims([broken, ANSWERS[2]]) == [(0.97, True)]


def test_a_set_that_holds_the_truth_is_counted_beside() -> None:
    assert [a.covered for a in ANSWERS] == [True, False, True, True, True, True, False, True, False]


def test_what_is_wrong_is_listed_with_what_was_said() -> None:
    misses = text([*ANSWERS, answer("single", ["creep"], "", error="case.csv: row 3: no number")]).split("misses:")[1]
    assert "healthy -> effect: lvdt_drift 0.60" in misses
    assert "creep, stiction -> effects: creep 0.97, lvdt_drift 0.60" in misses
    assert "ended in an error: case.csv: row 3: no number" in misses
    assert "bent_rod -> unexplained" not in misses


@pytest.mark.parametrize(("name", "stage"), [("parameter:ep_tau", "ep"), ("stiction", "actuator")])
def test_the_stage_is_the_vocabularys(name: str, stage: str) -> None:
    assert [cause.stage for cause in label_of("case01", {"cls": "single", "truth": [name]}).causes] == [stage]


@pytest.mark.parametrize(
    ("sealed", "words"),
    [
        ({"cls": "single", "truth": ["sticktion"]}, "case07: cause 'sticktion' is not in the vocabulary"),
        ({"cls": "number", "truth": ["parameter:dead_band"]}, "case07: cause 'parameter:dead_band' is not in"),
        ({"cls": "nogap", "truth": []}, "case07: class 'nogap' is none of healthy, number"),
    ],
)
def test_a_name_that_nobody_knows_is_an_error(sealed: dict[str, Any], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        label_of("case07", sealed)


def write(path: Path, plant: Plant, seed: int, noisy: bool) -> np.ndarray:
    """A record of a plant as a stranger's CSV; the noise-free reading [in]."""
    dice, n = np.random.default_rng(seed), 1200
    command = np.repeat(dice.uniform(4.5, 13.0, 24), 50)
    blank = Recording("valve", np.arange(n) * 0.2, command, np.zeros(n), command)
    pressure, position = simulate_recording(plant, blank)
    noise = dice.normal(0.0, 5e-4, n) if noisy else np.zeros(n)
    columns = np.column_stack((blank.time_s, command, pressure + 4.0 * noise, position + noise))
    path.parent.mkdir(parents=True, exist_ok=True)
    head = "time_s,command_psi,pressure_psi,position_in"
    np.savetxt(path, columns, delimiter=",", header=head, comments="", fmt="%.6f")
    return position


@pytest.mark.thorough
def test_a_folder_is_answered_and_scored(tmp_path: Path, monkeypatch, capsys) -> None:
    folder, out, kept = tmp_path / "sealed_77", tmp_path / "answers", tmp_path / "claims.json"
    wrong = Inserted("lvdt_calibration", effect("lvdt_calibration").form("gain"), (0.05,))
    for case, plant in {"case01": Plant(DesignModel()), "case02": Plant(DesignModel(), (wrong,))}.items():
        write(folder / case / "run1.csv", plant, 1, noisy=True)
        reading_in = write(folder / "unseen" / f"{case}.csv", plant, 2, noisy=False)
        np.savez(folder / "unseen" / f"{case}.npz", x_analog=reading_in)
    save_design(DesignModel(), folder / "design.toml")
    sealed = {"case01": {"cls": "healthy", "truth": []}, "case02": {"cls": "single", "truth": ["lvdt_calibration"]}}
    monkeypatch.setattr(
        sys, "argv", ["exam", str(folder), "--out", str(out), "--processes", "2", "--claims", str(kept)]
    )
    with pytest.raises(FileNotFoundError):  # no labels yet: the answers are there all the same
        exam.main()
    assert sorted(path.name for path in out.glob("*.json")) == ["case01.json", "case02.json"]
    (folder / "SEALED.json").write_text(json.dumps(sealed | {"case02": {"cls": "odd", "truth": []}}), encoding="utf-8")
    with pytest.raises(SystemExit, match="case02: class 'odd'"):
        exam.main()
    (folder / "SEALED.json").write_text(json.dumps({"case01": sealed["case01"]}), encoding="utf-8")
    with pytest.raises(SystemExit, match="case02 has no label"):
        exam.main()
    (folder / "SEALED.json").write_text(json.dumps({"seed": 1, "cases": sealed}), encoding="utf-8")
    assert not kept.exists()  # nothing is kept of a folder that cannot be scored
    exam.main()
    assert [true for _, true, _ in read(kept)["77"]] == [1]
    said = capsys.readouterr().out
    assert "| 2 | 2 of 2 | 1 of 1 | 1 of 1 | 1 of 1 | 0 of 0 | 0 of 0 |" in said
    assert "closure on an unseen record: median 0.99" in said or "median 1.0" in said


def unseen(folder: Path, out: Path, model: DesignModel) -> Path:
    """An unseen record of a valve as designed, and `model` as what was made of it; the record's file."""
    out.mkdir()
    reading_in = write(folder / "unseen" / "case01.csv", Plant(DesignModel()), 2, noisy=False)
    np.savez(folder / "unseen" / "case01.npz", x_analog=reading_in)
    save_design(DesignModel(), folder / "design.toml")
    save_design(model, out / "model.toml")
    return folder / "unseen" / "case01.csv"


@pytest.mark.thorough
def test_an_analogue_reading_is_compared_with_a_model_without_what_is_digital(tmp_path: Path) -> None:
    out = tmp_path / "answers"
    rounding, creep = {"form": "uniform_steps", "step": 0.05}, {"form": "one_tail", "share": 0.1, "tail": 30.0}
    unseen(tmp_path, out, replace(DesignModel(), effects={"sensor_quantization": rounding}))
    found = exam._unseen(tmp_path, out, "case01")
    assert found is not None and found["after_in"] == found["before_in"]
    save_design(replace(DesignModel(), effects={"sensor_quantization": rounding, "creep": creep}), out / "model.toml")
    found = exam._unseen(tmp_path, out, "case01")
    assert found is not None and found["after_in"] > found["before_in"] + 0.001  # what is not digital stays


@pytest.mark.parametrize(("zero", "kept"), [(-0.025, False), (-0.02, True), (0.025, True)])
def test_a_display_that_cuts_off_takes_its_half_step_along(zero: float, kept: bool) -> None:
    rounding, low = {"form": "uniform_steps", "step": 0.05}, {"form": "zero", "zero": zero}
    model = replace(DesignModel(), effects={"lvdt_calibration": low, "sensor_quantization": rounding})
    assert exam._analogue(model).effects == ({"lvdt_calibration": low} if kept else {})
    alone = replace(DesignModel(), effects={"lvdt_calibration": low})
    assert exam._analogue(alone).effects == {"lvdt_calibration": low}


def test_the_travel_is_in_inches_whatever_the_designs_units(tmp_path: Path) -> None:
    assert exam._travel_in(tmp_path / "none.toml") == DesignModel().travel
    metric = in_units_of(DesignModel(), "kPa", "mm")
    save_design(metric, tmp_path / "design.toml")
    assert metric.travel == pytest.approx(14.2875)
    assert exam._travel_in(tmp_path / "design.toml") == pytest.approx(DesignModel().travel)


@pytest.mark.thorough
def test_an_unseen_record_that_cannot_be_simulated_is_told_and_has_no_closure(tmp_path: Path, capsys) -> None:
    out = tmp_path / "answers"
    unseen(tmp_path, out, DesignModel()).write_text("time_s,position_in\n0.0,0.1\n", encoding="utf-8")
    assert exam._unseen(tmp_path, out, "case01") is None
    assert "case01: the unseen record cannot be simulated" in capsys.readouterr().err


@pytest.mark.parametrize(("header", "inch"), [("position_mm", 25.4), ("position_in", 1.0), ("position", 1.0)])
def test_an_unseen_reading_is_in_the_unit_of_its_record(tmp_path: Path, header: str, inch: float) -> None:
    record = tmp_path / "case01.csv"
    record.write_text(f"time_s,command_psi,{header}\n0,3,0\n", encoding="utf-8")
    assert exam._unit_in(record) * inch == pytest.approx(1.0)
