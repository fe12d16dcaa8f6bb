"""The `[effects.NAME]` tables of a model file: the forms they mean, and what is wrong with a wrong one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from control.design import DesignModel, load_design, save_design
from hal.errors import BadInput
from twin.model.insert import inserted_from
from twin.model.plant import effect_tables


def one(name: str, table: Mapping[str, float | str]) -> str:
    (found,) = inserted_from(DesignModel(effects={name: table}))
    return f"{found.effect}.{found.form.name}{found.values}"


def test_form_is_optional_where_the_parameters_tell() -> None:
    assert one("stiction", {"breakaway": 0.4}) == "stiction.one_jump(0.4,)"
    assert one("stiction", {"stick_speed": 2e-3, "breakaway": 0.4}) == "stiction.slip_until_slow(0.4, 0.002)"
    assert one("friction_in_motion", {}) == "friction_in_motion.full()"


def test_named_form() -> None:
    assert one("additional_lag", {"form": "before_play", "lag": 1}) == "additional_lag.before_play(1.0,)"


@pytest.mark.parametrize(
    ("name", "table", "sentence"),
    [
        ("stickyness", {}, r"\[effects.stickyness\]: no effect is called 'stickyness'; there are additional_lag"),
        ("stiction", {"form": "glue", "breakaway": 1.0}, "no such form; it has slip_until_slow"),
        ("stiction", {"form": "one_jump", "breakaway": 1.0, "x": 2.0}, r"x: form one_jump has no such parameter"),
        ("stiction", {"form": "one_jump"}, "breakaway is missing"),
        ("stiction", {"slip": 1.0}, "parameters slip, which fit no form"),
        ("sensor_lag", {"lag": "long"}, "lag = 'long' is not a finite number"),
        ("sensor_lag", {"lag": float("nan")}, "not a finite number"),
    ],
)
def test_wrong_tables(name: str, table: Mapping[str, float | str], sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        one(name, table)


def test_through_a_file_and_back(tmp_path: Path) -> None:
    tables = {
        "creep": {"form": "two_tails", "share": 0.1, "tail": 12.0},
        "dead_time": {"form": "pure_delay", "delay": 0.2},
    }
    save_design(DesignModel(effects=tables), tmp_path / "model.toml")
    assert effect_tables(inserted_from(load_design(tmp_path / "model.toml"))) == tables
