"""The table of docs/controllers.md is what docs/held-out.json says, and that is what the code computes today."""

from __future__ import annotations

import copy
import shutil
from pathlib import Path

import pytest

from app.held_out import BEGIN, END, KEPT, block, load, write
from app.rivals import run_all
from control.compare import jobs
from control.design import DesignModel

DOCS = Path(__file__).parents[2] / "docs"


def shown() -> str:
    return (DOCS / "controllers.md").read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0].strip()


def test_the_page_shows_what_is_stored() -> None:
    drawn, named = load(DOCS)
    assert shown() == block(drawn, named)


def test_a_number_that_moves_is_seen() -> None:
    drawn, named = copy.deepcopy(load(DOCS))
    drawn["trials"]["ramps"]["steady"][0] = 9.0
    assert shown() != block(drawn, named)


@pytest.mark.thorough
@pytest.mark.parametrize("scenario", ["dead_time", "stiction"])
def test_what_is_stored_is_what_comes_out(scenario: str) -> None:
    """One trial each of the scenarios in which the last bit mattered most."""
    drawn, _ = load(DOCS)
    (found,) = run_all(jobs(["brake"], [scenario], [drawn["first_seed"]], 0.1, DesignModel(), held_out=True), 1)
    row = drawn["trials"][scenario]
    was = {key: row[key][0] for key in KEPT if row[key][0] is not None}
    assert {key: getattr(found.score, key) for key in was} == pytest.approx(was, abs=1e-4)


def test_writing_keeps_the_rest_of_the_page(tmp_path: Path) -> None:
    for name in ("controllers.md", "held-out.json"):
        shutil.copy(DOCS / name, tmp_path / name)
    drawn, named = load(DOCS)
    write(tmp_path, drawn, named)
    assert (tmp_path / "controllers.md").read_text() == (DOCS / "controllers.md").read_text()
    assert load(tmp_path) == (drawn, named)
