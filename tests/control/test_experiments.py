"""Every kind of experiment that is found keeps the promises of all experiments."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from control.experiment_catalog import (
    FOLDER,
    defaults_for,
    experiment_class,
    experiment_kinds,
    make_experiment,
    parse_settings,
)
from control.experiment_file import from_plain, load_experiment, save_experiment, to_plain
from control.experiments.multisine import Multisine
from hal.errors import BadInput

KINDS = experiment_kinds()
PROMISED = {"staircase", "nested", "ramp", "steps", "random", "multisine", "hold"}


def test_every_file_is_a_kind_and_the_promised_ones_are_there() -> None:
    assert set(KINDS) >= PROMISED
    assert set(KINDS) == {path.stem for path in FOLDER.glob("*.py")} - {"__init__"}
    for kind in KINDS:
        assert experiment_class(kind).kind == kind


@pytest.mark.parametrize("kind", KINDS)
def test_the_schedule_is_as_long_and_as_wide_as_announced(kind: str) -> None:
    experiment = make_experiment(kind)
    schedule = experiment.commands()
    low, high = experiment.range
    assert schedule.command.min() >= low - 1e-9
    assert schedule.command.max() <= high + 1e-9
    ticks = sum(step.ticks(experiment.period_s) for step in (*experiment.conditioning_steps(), *experiment.steps()))
    assert schedule.command.size == ticks
    assert ticks * experiment.period_s == pytest.approx(experiment.duration_s, rel=2e-3)
    assert schedule.step[0] == -1
    assert schedule.step[-1] == len(experiment.steps()) - 1


@pytest.mark.parametrize("kind", sorted(set(KINDS) - {"hold", "points"}))
def test_the_defaults_go_through_both_curves_and_both_stops(kind: str) -> None:
    command = make_experiment(kind, {"conditioning": False}).commands().command
    assert command.min() < 5.82
    assert command.max() > 8.78 + 0.5625 / 0.19


@pytest.mark.parametrize("kind", KINDS)
def test_it_survives_its_file(kind: str, tmp_path: Path) -> None:
    experiment = make_experiment(kind, {"note": 'it\'s "quoted"', "seed": 7, "repeats": 2})
    save_experiment(experiment, tmp_path / "e.toml", comment="why")
    assert load_experiment(tmp_path / "e.toml") == experiment
    assert from_plain(to_plain(experiment), "here") == experiment


@pytest.mark.parametrize("kind", KINDS)
def test_in_percent_the_defaults_fill_0_to_100(kind: str) -> None:
    low, high = make_experiment(kind, {"unit": "percent"}).range
    assert (low, high) == pytest.approx((0.0, 100.0))
    assert defaults_for(kind, "percent")["unit"] == "percent"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"colour": "red"}, "no setting 'colour'"),
        ({"period_s": 0.0}, "period_s = 0.0 must be at least"),
        ({"period_s": float("nan")}, "finite number"),
        ({"repeats": 1.5}, "whole number"),
        ({"repeats": 0}, "at least 1"),
        ({"conditioning": 1}, "true or false"),
        ({"unit": "bar"}, "must be one of psi, percent"),
        ({"conditioning_low": 14.0}, "below conditioning_high"),
    ],
)
def test_what_cannot_be_is_refused_in_words(kind: str, settings: dict[str, object], words: str) -> None:
    with pytest.raises(BadInput, match=words) as caught:
        make_experiment(kind, settings)
    assert kind in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "settings"),
    [
        ("staircase", {"low": 9.0, "high": 8.0}),
        ("nested", {"centre": 20.0}),
        ("nested", {"smallest": 30.0}),
        ("ramp", {"low": 13.0, "high": 13.0}),
        ("steps", {"low": 13.0}),
        ("random", {"dwell_min_s": 30.0}),
        ("multisine", {"highest_hz": 0.001}),
        ("multisine", {"highest_hz": 8.0}),
        ("points", {"points": []}),
        ("points", {"points": [[9.0, 1.0]]}),
        ("points", {"points": [[9.0, -1.0, 2.0]]}),
        ("points", {"points": [["a", 0.0, 2.0]]}),
    ],
)
def test_numbers_that_do_not_go_together_are_refused(kind: str, settings: dict[str, object]) -> None:
    with pytest.raises(BadInput, match=f"experiment {kind}"):
        make_experiment(kind, settings)


def test_the_seed_decides_what_is_random() -> None:
    one, again, other = (make_experiment("random", {"seed": seed}).commands().command for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_a_staircase_goes_up_and_down_in_equal_steps() -> None:
    experiment = make_experiment("staircase", {"low": 4.0, "high": 5.0, "step": 0.3, "conditioning": False})
    ends = [step.end for step in experiment.steps()]
    assert ends == pytest.approx([4.3, 4.6, 4.9, 5.0, 4.7, 4.4, 4.1, 4.0])


def test_nested_loops_close_in_on_the_centre() -> None:
    experiment = make_experiment("nested", {"loops": 3})
    ends = np.array([step.end for step in experiment.steps()])
    turns = ends[1:-1][np.diff(ends)[:-1] * np.diff(ends)[1:] < 0.0]
    widths = np.abs(np.diff(turns))[:5]
    assert turns.size == 7
    assert widths[-1] == pytest.approx(2.0)
    assert (np.diff(widths) < 0.0).all()
    assert ends[-1] == 4.0


def test_a_multisine_stays_in_its_bounds_and_uses_them() -> None:
    command = Multisine(conditioning=False).commands(0.02).command
    assert np.abs(command - 8.7).max() <= 4.3
    assert np.abs(command - 8.7).max() > 4.1


def test_an_unknown_kind_and_a_broken_file_are_named(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="'sawtooth' does not exist; choose one of hold, multisine"):
        make_experiment("sawtooth")
    (tmp_path / "bad.toml").write_text("kind = \n", encoding="utf-8")
    with pytest.raises(BadInput, match=r"bad\.toml: not a TOML file"):
        load_experiment(tmp_path / "bad.toml")
    (tmp_path / "none.toml").write_text("low = 3.0\n", encoding="utf-8")
    with pytest.raises(BadInput, match=r"none\.toml: key 'kind' is missing"):
        load_experiment(tmp_path / "none.toml")
    with pytest.raises(BadInput, match=r"absent\.toml: the experiment cannot be read"):
        load_experiment(tmp_path / "absent.toml")


def test_settings_are_read_like_toml() -> None:
    words = ["step=0.1", "until_settled=true", "points=[[9, 0, 5]]", "note=hello world", "unit=percent"]
    assert parse_settings(words) == {
        "step": 0.1,
        "until_settled": True,
        "points": [[9, 0, 5]],
        "note": "hello world",
        "unit": "percent",
    }
    with pytest.raises(BadInput, match="'step' is not of the form"):
        parse_settings(["step"])
