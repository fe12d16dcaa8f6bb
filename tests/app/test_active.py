"""The circle of diagnosis and experiment: it goes on while there is something to learn, and knows why it stops."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from app.active import Pursuit, Round, first_experiment, pursue, runner
from app.cli import cli
from app.commands.diagnose import command as diagnose_verb
from control.experiment import Experiment
from control.experiment_catalog import make_experiment
from hal.errors import BadInput
from logs.recording import Recording
from logs.run import read_run
from twin.diagnosis import NextExperiment

SHORT = 'kind = "hold"\nhold_s = {0}\nconditioning = false\n'
Said = tuple[float, tuple[str, ...], str | None]  # probability, confusion set, text of the next experiment


class Circle:
    """Diagnoses by a script, and remembers which experiments were asked for."""

    def __init__(self, *script: Said) -> None:
        self.script = list(script)
        self.made: list[Experiment] = []
        self.seen: list[int] = []
        self.told: list[Round] = []

    def run(self, experiment: Experiment) -> Recording:
        self.made.append(experiment)
        return empty()

    def diagnose(self, known: Sequence[Recording]) -> SimpleNamespace:
        self.seen.append(len(known))
        probability, names, text = self.script.pop(0)
        diagnosis = SimpleNamespace(
            verdict="effect",
            causes=(SimpleNamespace(name="stiction", probability=probability),),
            confusable=(names,) if names else (),
            next_experiment=NextExperiment("because", "next.toml" if text else None),
        )
        return SimpleNamespace(diagnosis=diagnosis, next_file=text)

    def go(self, first: Experiment | None, budget_minutes: float = 60.0, known: int = 0) -> Pursuit:
        recordings = [empty()] * known
        return pursue(recordings, first, budget_minutes, self.run, self.diagnose, self.told.append)  # type: ignore[arg-type]


def empty() -> Recording:
    return Recording("r", np.arange(2.0), np.zeros(2), np.zeros(2))


FIRST = make_experiment("hold", {"hold_s": 60.0, "conditioning": False})


def test_goes_on_until_it_is_sure() -> None:
    circle = Circle((0.6, ("stiction", "creep"), SHORT.format(60)), (0.97, (), SHORT.format(30)))
    pursuit = circle.go(FIRST)
    assert pursuit.why == "it is sure"
    assert [one.duration_s for one in circle.made] == [60.0, 60.0]
    assert circle.seen == [1, 2]
    assert [one.bench_minutes for one in circle.told] == pytest.approx([1.0, 2.0])
    assert pursuit.rounds == tuple(circle.told)


def test_a_probable_cause_with_a_twin_is_not_sure() -> None:
    circle = Circle((0.99, ("stiction", "creep"), SHORT.format(60)), (0.99, (), None))
    assert circle.go(None, known=1).why == "it is sure"
    assert circle.seen == [1, 2]


def test_stops_where_no_experiment_would_help() -> None:
    circle = Circle((0.6, ("sensor_lag", "additional_lag"), None))
    assert circle.go(FIRST).why == "no experiment would tell more. because"
    assert len(circle.made) == 1


def test_stops_before_the_budget_is_exceeded() -> None:
    circle = Circle((0.6, (), SHORT.format(600)))
    pursuit = circle.go(FIRST, budget_minutes=5.0)
    assert pursuit.why == "the next experiment takes 10.0 min, and 4.0 min are left"
    assert circle.made == [FIRST]


def test_never_makes_the_same_experiment_twice() -> None:
    circle = Circle(*[(0.6, (), SHORT.format(60))] * 3)
    assert "has been made" in circle.go(FIRST).why
    assert len(circle.made) == 2


def test_refuses_a_first_experiment_beyond_the_budget() -> None:
    with pytest.raises(BadInput, match=r"takes 1\.0 min, --budget-minutes is 0\.5"):
        Circle().go(FIRST, budget_minutes=0.5)


def test_begins_with_the_nested_sweep_or_what_fits() -> None:
    assert first_experiment("psi", 60.0).kind == "nested"
    short = first_experiment("percent", 12.0)
    assert (short.kind, short.unit) == ("random", "percent")
    assert short.duration_s <= 720.0
    with pytest.raises(BadInput, match="too short"):
        first_experiment("psi", 1.0)


def test_runs_experiments_on_the_virtual_bench_one_after_the_other(tmp_path: Path) -> None:
    small = make_experiment("hold", {"at": 10.0, "hold_s": 5.0, "conditioning": False})
    with runner(tmp_path, seed=1) as run:
        records = [run(small), run(small)]
    assert [record.n for record in records] == [50, 50]
    runs = [read_run(tmp_path / f"run-{number}") for number in (1, 2)]
    assert [run.status for run in runs] == ["success", "success"]
    experiment = runs[0].start["experiment"]
    assert isinstance(experiment, dict)
    assert experiment["kind"] == "hold"
    # the valve is the same one: it has lived on and its noise with it
    assert not np.array_equal(records[0].position, records[1].position)


@pytest.mark.thorough
def test_the_verb_closes_the_circle_on_the_virtual_bench(tmp_path: Path) -> None:
    words = ["diagnose", "--active", "--budget-minutes", "4.5", "--out", str(tmp_path)]
    said = CliRunner().invoke(cli, words)
    assert said.exit_code == 0, said.output
    rounds = json.loads((tmp_path / "rounds.json").read_text(encoding="utf-8"))
    assert rounds["why"]
    assert [one["verdict"] for one in rounds["rounds"]] == ["no_gap"]
    assert rounds["rounds"][0]["records"] == 1
    assert (tmp_path / "diagnosis.json").is_file()
    assert "The valve will move" in said.output


def test_without_active_a_run_is_needed_and_a_bench_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="name a run"):
        diagnose_verb.main(["--out", str(tmp_path)], standalone_mode=False)
    (tmp_path / "a.csv").write_text("time_s,command_psi,position_in\n0,5,0\n0.1,5,0\n0.2,5,0\n", encoding="utf-8")
    with pytest.raises(BadInput, match="need --active"):
        words = [str(tmp_path / "a.csv"), "--physics", "thesis", "--out", str(tmp_path)]
        diagnose_verb.main(words, standalone_mode=False)
