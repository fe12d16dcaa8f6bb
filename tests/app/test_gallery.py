"""docs/thesis.md is what the code computes today: a part of the numbers is recomputed, and the whole page is re-set."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner

from app.commands.thesis import command as thesis
from app.gallery import page
from app.gallery.figure import Entry, Number
from app.gallery.index import KEYS, make
from hal.errors import BadInput, JobFailed

DOCS = Path(__file__).parents[2] / "docs"
made = cache(make)  # some items take seconds
QUICK = ("1-5", "1-6", "2-4", "2-5", "2-7", "3-5", "3-7", "3-9", "3-10", "3-12")


@pytest.mark.parametrize("key", QUICK)
def test_the_stored_numbers_are_not_stale(key: str) -> None:
    page.check(DOCS, [made(key)])


def test_the_page_shows_the_stored_numbers_and_pictures() -> None:
    text = (DOCS / "thesis.md").read_text(encoding="utf-8")
    stored = json.loads((DOCS / "thesis.json").read_text(encoding="utf-8"))
    for key in QUICK:
        entry = made(key)
        assert f"## {entry.title}" in text
        shown = tuple(Number(n.label, n.thesis, stored[key][n.label], n.unit, n.digits) for n in entry.numbers)
        assert "\n".join(page._table(shown)) in text
    for key in KEYS:
        assert f"pictures/thesis-{key}.png" in text
        assert (DOCS / "pictures" / f"thesis-{key}.png").is_file()


def test_what_the_thesis_saw_emerges() -> None:
    """The order of the thesis's findings, on one bench, with room for other chance."""
    by_key = {key: {n.label: n.ours for n in made(key).numbers} for key in ("3-7", "3-10", "3-12")}
    assert by_key["3-7"]["largest bounce"] > 10.0
    line, pi = by_key["3-10"], by_key["3-12"]
    assert line["largest swing of a hold"] < 0.5
    assert 1.5 < line["largest error, opening"] < 3.0
    assert line["largest error, closing"] < 0.15 * line["largest error, opening"]  # only when opening
    assert line["median over 8 seeds, closing"] < 0.3 * line["median over 8 seeds, opening"]
    assert line["largest error, valve as designed"] < 0.5
    assert pi["largest steady error"] < 0.75 * line["largest error, opening"]


def test_a_stale_number_is_named(tmp_path: Path) -> None:
    entry = Entry("x", "X", "", "", (Number("speed", 1.0, 2.0, "in/s"),))
    (tmp_path / "thesis.json").write_text(json.dumps({"x": {"speed": 2.005}}), encoding="utf-8")
    page.check(tmp_path, [entry])
    (tmp_path / "thesis.json").write_text(json.dumps({"x": {"speed": 2.2}}), encoding="utf-8")
    with pytest.raises(JobFailed, match=r"x speed: 2.2 -> 2"):
        page.check(tmp_path, [entry])


def test_one_item_on_the_command_line(tmp_path: Path) -> None:
    runner = CliRunner()
    done = runner.invoke(thesis, ["3-9", "2-3", "--plot", str(tmp_path), "--json"], catch_exceptions=False)
    assert json.loads(done.output)["3-9"]["distance to the closing curve"] == pytest.approx(1.48)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["thesis-2-3.png", "thesis-3-9.png"]
    with pytest.raises(BadInput, match="has no item"):
        runner.invoke(thesis, ["9-9"], catch_exceptions=False)
