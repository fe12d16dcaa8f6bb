"""`lostmotion diagnose` on a stranger's files: what they are read as, what is said of them, what is refused."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import run
from logs.recording import FloatArray, Recording
from tests.control.toy_valve import Toy, random_steps, record, respond

PERCENT = Toy(ep_tau=0.2, a1=10.0, a2=10.0, k1=1.1, k2=1.1, tau=3.0, rate=1e9, travel=100.0)


@pytest.fixture(scope="module")
def healthy() -> Recording:
    """200 s of the design's own valve at 5 Hz."""
    return record(Toy(), np.arange(0.0, 200.0, 0.2), random_steps(200.0, 0.2), noise_p=0.02, noise_x=8e-4)


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """The report and the view have tests of their own."""
    monkeypatch.setattr("twin.write.write_report", lambda *_: None)
    monkeypatch.setattr("twin.write.write_rrd", lambda *_: None)


def write(path: Path, columns: Mapping[str, FloatArray]) -> str:
    table = np.column_stack(list(columns.values()))
    rows = [",".join("" if np.isnan(v) else f"{v:.8g}" for v in row) for row in table]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    return str(path)


def columns_of(recording: Recording) -> dict[str, FloatArray]:
    assert recording.pressure is not None
    return {
        "time_s": recording.time_s,
        "command_psi": recording.command,
        "pressure_psi": recording.pressure,
        "position_in": recording.position,
    }


def diagnosed(out: Path, *words: str) -> dict[str, Any]:
    assert run(["diagnose", *words, "--out", str(out)]) == 0
    document: dict[str, Any] = json.loads((out / "diagnosis.json").read_text())
    assert (out / "model.toml").is_file()
    return document


def said(document: dict[str, Any]) -> str:
    return "; ".join(f"{note['what']}: {note['handled']}" for note in document["data_quality"])


@pytest.mark.thorough
def test_other_units_and_no_pressure(healthy: Recording, tmp_path: Path) -> None:
    columns = {"t": healthy.time_s * 1e3, "u": healthy.command * 6.894757, "x": healthy.position * 25.4}
    words = ["--map", "time=t,command=u,position=x", "--units", "time=ms,command=kPa,position=mm"]
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", columns), *words)
    assert found["verdict"] == "no_gap"
    assert found["where"]["stage"] is None
    assert "the E/P and actuator stages cannot be separated" in said(found)
    assert "no --design given: identified from the record" in said(found)
    assert "a deadband of 20.4 kPa, be it play or friction, is in the design" in said(found)


@pytest.mark.thorough
def test_missing_values_doubled_rows_and_a_hole(healthy: Recording, tmp_path: Path) -> None:
    columns = {name: values.copy() for name, values in columns_of(healthy).items()}
    columns["position_in"][50:900:37] = np.nan
    columns["time_s"][700] = columns["time_s"][699]
    kept = np.r_[0:400, 520:1000]  # 24 s are missing, with commands that nobody knows
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", {n: v[kept] for n, v in columns.items()}))
    assert found["verdict"] == "no_gap"
    for words in ("missing values", "time of the row before", "cut into 2 pieces"):
        assert words in said(found)


@pytest.mark.thorough
@pytest.mark.parametrize("words", ["after", "unknown"])
def test_a_command_that_takes_effect_after_its_row(
    healthy: Recording, tmp_path: Path, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = columns_of(healthy)
    columns["command_psi"] = np.append(columns["command_psi"][1:], columns["command_psi"][-1])
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", columns), "--command-timing", words)
    assert found["verdict"] == "no_gap"
    minded = capsys.readouterr().out
    assert "Mind: no --design given: the defaults; the thesis's numbers are" in minded
    assert "of another valve, identify a design first" in minded


@pytest.mark.thorough
def test_one_hertz_with_jitter(tmp_path: Path) -> None:
    steps = np.random.default_rng(3).uniform(0.6, 1.4, 400)
    time_s = np.cumsum(np.round(steps, 2))
    toy = record(Toy(), time_s, random_steps(400.0, 1.0)[:400], noise_p=0.02, noise_x=8e-4)
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", columns_of(toy)))
    assert found["verdict"] == "no_gap"
    assert "uneven sampling" in said(found)


@pytest.mark.thorough
def test_a_plain_gain_and_lag_in_percent_without_a_design(tmp_path: Path) -> None:
    time_s = np.arange(0.0, 300.0, 0.5)
    command = random_steps(300.0, 0.5, low=0.0, high=100.0)
    _, x = respond(PERCENT, time_s, command, step_s=0.02)
    columns = {"t": time_s, "OP": command, "PV": x + 0.1 * np.random.default_rng(1).standard_normal(x.size)}
    words = ["--map", "time=t,command=OP,position=PV", "--units", "command=percent,position=percent"]
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", columns), *words)
    assert found["verdict"] == "no_gap"
    assert "identified from the record" in said(found)


@pytest.mark.thorough
def test_a_misleading_design_is_said_to_be_off(healthy: Recording, tmp_path: Path) -> None:
    model = tmp_path / "wrong.toml"
    model.write_text(
        '[units]\npressure = "psi"\nposition = "in"\ntime = "s"\n[ep]\ntau = 0.3\n[valve]\na1 = 13.78\na2 = 5.82\n'
        "compliance = 0.19\ntau = 2.7\nrate_limit = 0.12\ntravel = 0.5625\n"
    )
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", columns_of(healthy)), "--design", str(model))
    assert found["verdict"] == "parameter"
    assert {c["name"] for c in found["causes"]} == {"parameter:deadband", "parameter:offset"}
    sizes = {n: e["value"] for c in found["causes"] for n, e in c["parameters"].items()}
    assert sizes == pytest.approx({"deadband": 2.96, "offset": 7.3}, rel=0.01)


@pytest.mark.thorough
def test_several_records_count_together(tmp_path: Path) -> None:
    time_s, command = np.arange(0.0, 120.0, 0.2), random_steps(120.0, 0.2)
    files = [
        write(tmp_path / f"{k}.csv", columns_of(record(Toy(), time_s, command, seed=k, noise_x=8e-4))) for k in (1, 2)
    ]
    found = diagnosed(tmp_path / "d", *files)
    assert found["verdict"] == "no_gap"
    assert found["noise"]["position"]["source"] == "repeats"


def _still(r: Recording) -> Recording:
    return replace(r, command=np.full(r.n, 7.0), position=0.2 + 1e-3 * np.sin(np.arange(r.n)))


def _stuck(r: Recording) -> Recording:
    return replace(r, position=0.2 + 1e-3 * np.sin(np.arange(r.n)))


def _inverted(r: Recording) -> Recording:
    return replace(r, position=0.5625 - r.position)


def _swapped(r: Recording) -> Recording:
    return replace(r, command=r.position, position=r.command)


def _backward(r: Recording) -> Recording:
    time_s = r.time_s.copy()
    time_s[600] = time_s[598]
    return replace(r, time_s=time_s)


def _few(r: Recording) -> Recording:
    return r.slice(0, 30)


def _kilopascal(r: Recording) -> Recording:
    assert r.pressure is not None
    return replace(r, command=6.9 * r.command, pressure=6.9 * r.pressure)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (_still, "nothing moves"),
        (_stuck, "the stem is stuck, the position sensor is not read"),
        (_inverted, "turn it round, as in --units"),
        (_swapped, "do not belong to a travel"),
        (_kilopascal, "--units command=kPa"),
        (_backward, "row 601"),
        (_few, "too few to diagnose"),
    ],
)
def test_what_cannot_be_diagnosed_is_refused_in_one_sentence(
    healthy: Recording, tmp_path: Path, change: Any, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(tmp_path / "x.csv", columns_of(change(healthy)))
    assert run(["diagnose", file, "--out", str(tmp_path / "d")]) == 2
    words = capsys.readouterr().err
    assert sentence in words
    assert words.count("\n") == 1
    assert not (tmp_path / "d" / "diagnosis.json").exists()


@pytest.mark.thorough
def test_the_hint_for_an_inverted_axis_works(healthy: Recording, tmp_path: Path) -> None:
    file = write(tmp_path / "x.csv", columns_of(_inverted(healthy)))
    found = diagnosed(tmp_path / "d", file, "--units", "position=in(0..0.5625=0.5625..0 in)")
    assert found["verdict"] == "no_gap"


@pytest.mark.thorough
def test_a_constant_pressure_is_no_measurement(healthy: Recording, tmp_path: Path) -> None:
    columns = columns_of(replace(healthy, pressure=np.full(healthy.n, 7.5)))
    found = diagnosed(tmp_path / "d", write(tmp_path / "x.csv", columns))
    assert found["verdict"] == "no_gap"
    assert found["where"]["stage"] is None
    assert "treated as not measured" in said(found)


def sticky_loop(rows: int = 240, breakaway: float = 4.0) -> dict[str, FloatArray]:
    """A loop in percent at 1 Hz as public stiction data have it: PI, a valve that sticks and slips, PV = its position.

    Written from the words of the two-parameter model: the valve holds until the command is `breakaway` away from it.
    """
    chance = np.random.default_rng(2)
    stem = value = command = integral = 50.0
    table = []
    for k in range(rows):
        target = 50.0 + 12.0 * ((k // 60) % 2)
        if abs(command - stem) > breakaway:
            stem = command
        value += (stem - value) * (1.0 - np.exp(-1.0 / 2.0))
        reading = value + 0.1 * chance.standard_normal()
        table.append((k, target, reading, command))
        integral += 0.08 * (target - reading)
        command = float(np.clip(integral + 0.3 * (target - reading), 0.0, 100.0))
    time_s, target_, reading_, command_ = np.array(table).T
    return {"Time (s)": time_s, "SP (%)": target_, "PV (%)": np.round(reading_, 2), "OP (%)": np.round(command_, 2)}


LOOP = ["--map", "time=Time (s),command=OP (%),position=PV (%),target=SP (%)", "--command-timing", "after"]
UNITY = """[units]
pressure = "percent"
position = "percent"
[ep]
tau = 0.1
[valve]
a1 = 0.0
a2 = 0.0
compliance = 1.0
tau = 2.0
rate_limit = 100.0
travel = 100.0
"""


@pytest.mark.thorough
def test_a_sticking_loop_against_a_valve_that_should_follow_one_to_one(tmp_path: Path) -> None:
    (tmp_path / "unity.toml").write_text(UNITY)
    file = write(tmp_path / "loop.csv", sticky_loop())
    found = diagnosed(tmp_path / "d", file, *LOOP, "--design", str(tmp_path / "unity.toml"))
    sizes = {c["name"]: c["parameters"] for c in found["causes"]}
    assert sizes["stiction"]["breakaway"]["value"] == pytest.approx(4.0, rel=0.1)
    assert found["where"]["stage"] is None


@pytest.mark.thorough
def test_a_loop_that_shows_no_curve_gives_no_design(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    columns = sticky_loop(rows=300)
    columns["OP (%)"] = np.roll(columns["OP (%)"], 77)  # what the valve was told has nothing to do with what it did
    file = write(tmp_path / "loop.csv", columns)
    assert run(["diagnose", file, *LOOP, "--out", str(tmp_path / "d")]) in (1, 2)
    assert "give the design as --design MODEL.toml (in percent and percent)" in capsys.readouterr().err
