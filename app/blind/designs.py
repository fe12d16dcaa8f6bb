"""What the diagnosis of a blind trial is held against: the model of the healthy machine of that family."""

from __future__ import annotations

import tomllib
from pathlib import Path

from control.design import DesignModel, load_design
from hal.errors import BadInput
from twin.fit.case import Margin

FOLDER = Path(__file__).parent / "baselines"


def baseline(family: str) -> DesignModel:
    """The thesis's numbers for `thesis`, the model identified from the healthy twin for `reference`.

    Raises: `BadInput` for a family without a baseline.
    """
    if family == "thesis":
        return DesignModel()
    path = FOLDER / f"{family}.toml"
    if not path.is_file():
        raise BadInput(f"{path}: family '{family}' has no baseline; make it with python bench/blind_baseline.py")
    return load_design(path)


def margin(family: str) -> Margin:
    """How far the healthy machine of a family is from its baseline on its own: 0 for `thesis`, which is its design."""
    path = FOLDER / f"{family}_margin.toml"
    if not path.is_file():
        return Margin()
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    return Margin(position=float(content["position_in"]), pressure=float(content["pressure_psi"]))
