"""Files with the mark that some editors put first, wherever the program reads TOML."""

from __future__ import annotations

import codecs
import tomllib
from datetime import date
from pathlib import Path

import pytest

from control.design import DesignModel, load_design, save_design
from control.experiment_file import load_experiment
from hal.calibration import Calibration
from hal.dial_gauge import write_profile
from hal.errors import BadInput
from hal.profile import FOLDER, load_profile
from hal.toml_file import read_toml


def marked(path: Path) -> Path:
    path.write_bytes(codecs.BOM_UTF8 + path.read_bytes())
    return path


def test_a_mark_at_the_beginning_is_no_part_of_the_file(tmp_path) -> None:
    profile = tmp_path / "mine.toml"
    profile.write_bytes((FOLDER / "virtual.toml").read_bytes())
    assert load_profile(marked(profile)) == load_profile("virtual")
    calibration = Calibration(id="new", made=date(2026, 11, 1), points=((-8.0, 0.0), (8.0, 0.5)))
    write_profile(profile, tmp_path / "calibrated.toml", calibration)
    assert load_profile(tmp_path / "calibrated.toml").calibration == calibration
    save_design(DesignModel(a1=9.0), tmp_path / "model.toml")
    assert load_design(marked(tmp_path / "model.toml")).a1 == 9.0
    (tmp_path / "sweep.toml").write_text('kind = "hold"\nat = 12.0\n', encoding="utf-8")
    assert load_experiment(marked(tmp_path / "sweep.toml")).kind == "hold"


@pytest.mark.parametrize("load", [load_profile, load_design, load_experiment])
def test_another_encoding_is_said_with_what_to_do(load, tmp_path) -> None:
    path = tmp_path / "x.toml"
    path.write_text("name = 1", encoding="utf-16")
    with pytest.raises(tomllib.TOMLDecodeError):
        read_toml(path)
    with pytest.raises(BadInput, match=r"x\.toml.*byte 1 is not UTF-8; save the file as UTF-8"):
        load(path)
