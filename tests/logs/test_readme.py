"""The README's snippets run on the reference runs, and say what the reader of this house says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from logs.layout import EVENTS, SAMPLES, START, STOP
from logs.load import load_recording
from logs.run import read_run

HOUSE = Path(__file__).resolve().parents[2]
REFERENCE = HOUSE / "logs" / "reference"


def snippets() -> list[str]:
    return re.findall(r"```python\n(.*?)```", (HOUSE / "logs" / "README.md").read_text(), re.DOTALL)


def test_a_run_is_read_without_our_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(HOUSE)
    known: dict[str, object] = {}
    exec(snippets()[0], known)
    samples, units = known["samples"], known["units"]
    run = read_run(REFERENCE / "staircase")
    assert samples.num_rows == run.rows > 1000  # type: ignore[attr-defined]
    assert units == run.units
    position = samples.column("position_in").to_numpy()  # type: ignore[attr-defined]
    assert np.array_equal(position, run.columns["position_in"])


def test_a_run_is_read_with_our_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(HOUSE)
    known: dict[str, object] = {}
    exec(snippets()[1], known)
    assert known["run"].status == "success"  # type: ignore[attr-defined]
    assert known["recording"].pressure is not None  # type: ignore[attr-defined]


@pytest.mark.parametrize("folder", sorted(REFERENCE.iterdir()), ids=lambda folder: folder.name)
def test_reference_runs_are_whole_small_and_name_no_machine(folder: Path) -> None:
    run = read_run(folder)
    assert run.status == "success" and run.problems == () and load_recording(folder).n == run.rows
    files = [folder / name for name in (START, SAMPLES, EVENTS, STOP)]
    assert sum(file.stat().st_size for file in files) < 200_000
    for file in files:
        assert b"/home/" not in file.read_bytes() and b"/root" not in file.read_bytes()
