"""The demo finds what the README says that it finds."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from control.design import load_design

HOUSE = Path(__file__).parents[2]


def told(pattern: str) -> tuple[float, ...]:
    """The numbers in what the README says, its line ends as spaces."""
    text = " ".join((HOUSE / "README.md").read_text(encoding="utf-8").split())
    found = re.search(pattern, text)
    assert found, pattern
    return tuple(map(float, found.groups()))


@pytest.mark.thorough
def test_the_demo_finds_what_the_readme_says(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "app", "demo", "--out", str(tmp_path / "demo")]
    wide = os.environ | {"COLUMNS": "160", "PYTHONIOENCODING": "utf-8"}
    shown = subprocess.run(command, cwd=HOUSE, env=wide, capture_output=True, text=True, check=True).stdout

    found = load_design(tmp_path / "demo" / "model.toml")
    for name, value in (
        ("a1, closing curve", found.a1),
        ("a2, opening curve", found.a2),
        ("compliance", found.compliance),
        ("time constant", found.tau_s),
    ):
        said, low, high = told(rf"\| {name} \| ([\d.]+) \(([\d.]+) \.\. ([\d.]+)\)")
        assert value == pytest.approx(said, rel=1e-3)
        assert low < value < high

    errors = [abs(float(e)) for e in re.findall(r"│ +[\d.]+ │ +[\d.]+ │ +[+-][\d.]+ │ +([+-][\d.]+) │", shown)]
    assert len(errors) == 5
    # where a loop with a band comes to rest depends on the last bits: 0.16 on one machine, 0.20 on others
    [most] = told(r"the mean error was ([\d.]+) % of travel or less")
    assert 0.5 * most < max(errors) < most + 0.011

    diagnosis = json.loads((tmp_path / "demo" / "sealed" / "diagnosis.json").read_text(encoding="utf-8"))
    [cause] = diagnosis["causes"]
    assert cause["name"] == "creep"
    assert cause["probability"] == pytest.approx(told(r"named creep of the actuator \(probability ([\d.]+)\)")[0])
    gap = diagnosis["gap"]
    said = told(r"fell from ([\d.]+) % to ([\d.]+) % of travel; the noise is ([\d.]+) %")
    assert (gap["before"], gap["after"], gap["noise_floor"]) == pytest.approx(said, rel=0.04)
    assert "creep" in shown.split("sealed: ")[1].splitlines()[0]
