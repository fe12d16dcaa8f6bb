"""Public recordings are prepared as their pages say, and what is said of them becomes a row."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from bench.public import loops, machines
from bench.public.__main__ import answered, found, row
from bench.public.recording import Recording
from control.design import load_design

_FIVE = ["PROCESSDATA", "8", "tagname\tMV\tPV\tSV", "desc", "fsMax"]


def stored(folder: Path, name: str, first: int, count: int = 200) -> None:
    """Hours from row `first` on, of a loop whose flow (150 at 100 %) is twice the output less 20 %."""
    output = 30.0 + 5.0 * np.sin(0.01 * np.arange(first, first + count))
    lines = [f"2024-06-09 00:00:00\t{mv:.9f}\t{1.5 * (2.0 * mv - 20.0):.9f}\t50.0" for mv in output]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text("\n".join([*_FIVE, *lines]) + "\n", encoding="utf-8")


@pytest.fixture
def clones(tmp_path: Path) -> Path:
    plant = tmp_path / loops.FOLDER / "plant_data"
    stored(plant / "stiction_data", "stic_2411FIC20102_0609_0957_Stick1=0.89.txt", 0)
    stored(plant / "stiction_data", "stic_2411FIC20102_1002_1627_Stick1=0.83.txt", 3)  # nearly the same hours
    stored(plant / "stiction_data", "stic_2411FIC20102_20241226_0953_Stick1=0.68.txt", 300)
    stored(plant / "non-stiction_data", "stic_RHT.7050-342_FIC11502_0628_0005_Stick1=0.txt", 50)
    return tmp_path


def test_hours_that_are_there_twice_are_taken_once(clones: Path, tmp_path: Path) -> None:
    said = [(one.group, one.name) for one in found(clones, tmp_path)]
    sticking = "2411FIC20102, called sticking"
    assert said == [(sticking, "06-09 09:57"), (sticking, "12-26 09:53"), ("FIC11502, called healthy", "06-28 00:05")]


def test_the_design_is_the_line_through_the_steady_states(clones: Path, tmp_path: Path) -> None:
    first = next(iter(found(clones, tmp_path)))
    design = load_design(Path(first.words[first.words.index("--design") + 1]))
    assert (design.compliance, design.a1, design.a2) == pytest.approx((2.0, 10.0, 10.0), rel=1e-6)
    assert first.file.read_text(encoding="utf-8").splitlines()[0] == _FIVE[2]
    assert "flow(0..150=0..100 percent)" in first.words[first.words.index("--units") + 1]


def test_an_hour_of_a_boiler_becomes_three_columns(tmp_path: Path) -> None:
    (tmp_path / "DABLib").mkdir()
    table = np.arange(33.0).reshape(11, 3)
    savemat(tmp_path / "DABLib" / "OneHourTestData_ExampleII.mat", {"OneHourTestData_ExampleII": table})
    (one,) = machines.damadics(tmp_path, tmp_path)
    assert np.loadtxt(one.file, delimiter=",", skiprows=1) == pytest.approx(table[[0, 5, 6]].T)


def test_what_is_said_becomes_a_row() -> None:
    one = Recording("valve", "an hour", "sticks", Path("x.csv"), ())
    gap = {"before": 1.234, "retuned": 0.5, "after": None, "noise_floor": 0.1}
    nil = {"value": 2e-25, "unit": "s"}  # what it has no size of says nothing
    sizes = {"slowness": nil, "breakaway": {"value": 0.1234, "unit": "psi"}, "speed": {"value": 1.0, "unit": "psi/s"}}
    cause = {"name": "stiction", "parameters": sizes, "probability": 0.9}
    said = {"gap": gap, "verdict": "effect", "causes": [cause], "confusable": [["stiction", "creep"]]}
    assert row(one, said) == "| valve, an hour | sticks | 1.2, 0.5, -, 0.1 | stiction 0.12 psi (0.90) | creep |"
    unexplained = said | {"causes": [], "confusable": [], "verdict": "unexplained"}
    assert row(one, unexplained) == "| valve, an hour | sticks | 1.2, 0.5, -, 0.1 | unexplained |  |"
    assert row(one, {"error": "no motion"}) == "| valve, an hour | sticks | - | no motion | |"


def test_what_cannot_be_diagnosed_says_why(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").write_text("time_s,command_psi,position_in\n0,1,2\n", encoding="utf-8")
    said = answered(tmp_path, Recording("a, b", "c", "", tmp_path / "empty.csv", ()))
    assert set(said) == {"error"} and "empty.csv" in said["error"]


def test_an_answer_that_was_interrupted_is_asked_for_once_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = Recording("valve", "an hour", "sticks", Path("x.csv"), ())
    place = tmp_path / "valve-an-hour"
    place.mkdir()
    (place / "diagnosis.json").write_text('{"complete": false, "verdict": "unexplained"}', encoding="utf-8")
    asked = []

    def call(*words: str) -> None:
        asked.append(words)
        if len(asked) == 2:
            (place / "diagnosis.json").write_text('{"complete": true, "verdict": "no_gap"}', encoding="utf-8")

    monkeypatch.setattr("bench.public.__main__.call", call)
    assert answered(tmp_path, one) == {"error": "interrupted"}
    assert answered(tmp_path, one) == answered(tmp_path, one) == {"complete": True, "verdict": "no_gap"}
    assert len(asked) == 2
