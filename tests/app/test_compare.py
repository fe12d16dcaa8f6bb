"""compare and analyse on the command line; trials without a wire against the same over Modbus."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import app.hunting
from app.commands.analyse import command as analyse
from app.commands.compare import _goal
from app.commands.compare import command as compare
from app.physics_bench import open_virtual
from app.rivals import run_all
from app.session import open_bench
from control.compare import Result, jobs
from control.controller import make_controller
from control.design import DesignModel, save_design
from control.held_out import FIRST_SEED
from control.trial import Opened, follow_targets, run_trial
from hal.errors import BadInput

DESIGN = DesignModel()


@pytest.mark.parametrize("name", ["overdrive", "if_then_line", "brake"])
def test_a_trial_without_a_wire_is_the_trial_over_modbus(name: str) -> None:
    """Same plant, same seed. Over Modbus the readings are rounded to the profile's registers, and that is all.

    Without noise, so that rounding cannot tip a decision.
    """
    targets = np.repeat([0.15, 0.4], 150)
    controller = make_controller(name, DESIGN)
    near = run_trial(open_virtual(5, noise=0.0), controller, targets, 0.1)
    with open_bench(seed=5, options={"noise": 0.0}) as session:
        wired = follow_targets(Opened(session.bench, session.clock), controller, targets, 0.1)
    assert np.abs(near.position_in - wired.position_in).max() < 0.01 * DESIGN.travel


def test_compare_prints_json() -> None:
    arguments = ["-c", "overdrive,p", "-s", "reversals", "--seeds", "1", "--processes", "1", "--json"]
    done = CliRunner().invoke(compare, arguments, catch_exceptions=False)
    said = json.loads(done.stdout)
    assert len(said["trials"]) == 2
    assert said["summary"]["overdrive"]["steady_worst"] < said["summary"]["p"]["steady_worst"]


def test_compare_says_which_seeds() -> None:
    common = ["-c", "if_then_line", "-s", "reversals", "--seeds", "1", "--processes", "1"]
    named, drawn = (
        CliRunner().invoke(compare, [*common, *more], catch_exceptions=False) for more in ([], ["--held-out"])
    )
    assert "seeds 0 to 0, sizes and targets as the scenarios name them" in named.stdout
    assert f"seeds {FIRST_SEED} to {FIRST_SEED}, sizes and targets drawn, held out" in drawn.stdout
    assert "the supply reaches every target" in named.stdout


def test_compare_prints_a_table_and_a_picture(tmp_path: Path) -> None:
    picture = tmp_path / "rivals.png"
    arguments = ["-c", "if_then_line", "-s", "ramps", "--seeds", "1", "--processes", "1", "--plot", str(picture)]
    done = CliRunner().invoke(compare, arguments, catch_exceptions=False)
    assert "if_then_line" in done.stdout
    assert picture.stat().st_size > 1000


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["-c", "pid"], "does not exist"), (["-s", "storm"], "does not exist"), (["--detail", "beauty"], "not a score")],
)
def test_compare_refuses_what_it_does_not_know(arguments: list[str], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        CliRunner().invoke(compare, arguments, catch_exceptions=False)


def test_the_goal_is_counted_per_controller_and_trial() -> None:
    """A steady error of 0.3 % is within the goal, 0.31 % is not; any limit cycle counts."""
    (one,) = run_all(jobs(["p"], ["ladder"], [0], 0.1, DESIGN), 1)
    sizes = {"pi": ((0.3, 0.0), (0.31, 0.0), (0.1, 0.4), (0.1, 0.0)), "p": ((9.0, 0.0),)}
    results = [
        Result(replace(one.job, controller=name), replace(one.score, steady=steady, cycle=cycle))
        for name, trials in sizes.items()
        for steady, cycle in trials
    ]
    assert _goal(results) == [
        "pi: 75 % (30 to 95 %) of 4 trials within 0.3 %, 75 % (30 to 95 %) without a limit cycle",
        "p: 0 % (0 to 79 %) of 1 trials within 0.3 %, 100 % (21 to 100 %) without a limit cycle",
    ]


def test_analyse_one_loop(tmp_path: Path) -> None:
    picture = tmp_path / "nyquist.png"
    arguments = ["--law", "p_incremental", "--kp", "3", "--json", "--plot", str(picture)]
    done = CliRunner().invoke(analyse, arguments, catch_exceptions=False)
    (case,) = json.loads(done.stdout)
    assert case["predicted"]["stable"]
    assert case["measured"]["period_s"] == pytest.approx(15.0, abs=0.5)
    assert picture.is_file()


@pytest.mark.thorough
def test_analyse_a_sweep_over_dead_time(tmp_path: Path) -> None:
    """The incremental law hunts without dead time and not with half a second of it."""
    table, picture = tmp_path / "gains.csv", tmp_path / "gains.png"
    arguments = ["--law", "p_incremental", "--sweep", "dead_time=0:0.5:2", "--csv", str(table), "--plot", str(picture)]
    done = CliRunner().invoke(analyse, arguments, catch_exceptions=False)
    head, hunts, calm = (line.split(",") for line in table.read_text(encoding="utf-8").splitlines())
    at = head.index("measured_swing_percent")
    assert float(hunts[at]) == pytest.approx(56.7, abs=2.0)
    assert calm[at] == ""
    assert "not found" in done.stdout and "without noise" in done.stdout
    assert picture.stat().st_size > 1000


def test_analyse_over_modbus_with_the_real_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.hunting, "study", partial(app.hunting.study, duration_s=300.0))  # of 1200, for speed
    done = CliRunner().invoke(analyse, ["--law", "pi", "--ki", "8", "--modbus", "--json"], catch_exceptions=False)
    (case,) = json.loads(done.stdout)
    assert 2.0 * case["measured"]["stem_in"] > DESIGN.travel > 2.0 * case["wired"]["stem_in"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--sweep", "kp=1:6:11"], "give --law"),
        (["--law", "p", "--sweep", "kp=1"], "of the form"),
        (["--law", "p", "--sweep", "mass=1:2:3"], "has no 'mass'"),
        (["--law", "p", "--sweep", "kp=2:1:3"], "FROM < TO"),
        (["--law", "p", "--ki", "1"], "only --law pi"),
    ],
)
def test_analyse_refuses_what_it_cannot_sweep(arguments: list[str], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        CliRunner().invoke(analyse, arguments, catch_exceptions=False)


def test_analyse_refuses_a_design_that_it_cannot_use(tmp_path: Path) -> None:
    model = tmp_path / "model.toml"
    save_design(DesignModel(a1=7.0, a2=7.0), model)
    with pytest.raises(BadInput, match="no deadband"):
        CliRunner().invoke(analyse, ["--design", str(model)], catch_exceptions=False)
