"""The oracle's table of docs/controllers.md is what docs/permitted-trials.json says, and that is computed today."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from app.permitted_trials import BEGIN, END, KEPT, PERIOD_S, block, load, play, write
from control.compare import Job
from control.design import DesignModel

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_shows_what_is_stored() -> None:
    page = (DOCS / "controllers.md").read_text(encoding="utf-8")
    assert page.partition(BEGIN)[2].partition(END)[0].strip() == block(load(DOCS))


@pytest.mark.parametrize("scenario", ["noise", "stiction", "ramps"])
def test_what_is_stored_is_what_comes_out(scenario: str) -> None:
    stored = load(DOCS)
    found = play(Job("oracle", scenario, stored["first_seed"], PERIOD_S, DesignModel(), held_out=True))
    was = {key: stored["trials"][scenario][key][0] for key in KEPT}
    assert {key: getattr(found, key) for key in KEPT} == pytest.approx(was, abs=1e-4)


def test_writing_keeps_the_rest_of_the_page(tmp_path: Path) -> None:
    for name in ("controllers.md", "permitted-trials.json"):
        shutil.copy(DOCS / name, tmp_path / name)
    write(tmp_path, load(DOCS))
    assert (tmp_path / "controllers.md").read_text() == (DOCS / "controllers.md").read_text()
