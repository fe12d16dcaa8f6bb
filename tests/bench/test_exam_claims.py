"""What was said with which probability is kept for each set of strangers' cases, and added up."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench import exam
from bench.blind_docs import HOUSE
from bench.blind_pages import figure, tables
from bench.blind_readme import GOALS, SETS, newest_sets, spread
from bench.blind_summary import MEASURES
from bench.exam_claims import claims_of, counted, keep, read, seed_of

HEADS = f"| plant | seed | cases | {' | '.join(measure.column for measure in MEASURES[1:])} |"
ROW = "| [x](strangers/x-plant.md) | {} | 40 | 7 of 8 | 23 of 28 | - | 3 of 7 | 3 of 4 | 1.12 | 0.01 | 0.996 |"


@given(st.lists(st.tuples(st.sampled_from((0.97, 0.9, 0.75, 0.6)), st.booleans())))
def test_counting_loses_no_claim(claims: list[tuple[float, bool]]) -> None:
    assert sorted(claims_of({"7": counted(claims)}, ["7"])) == sorted(claims)


def test_a_set_is_known_by_the_digits_that_end_its_folders_name(tmp_path: Path, monkeypatch) -> None:
    assert seed_of(tmp_path / "second_set2_884417") == "884417"
    words = ["exam", str(tmp_path / "cases"), "--out", str(tmp_path / "out"), "--claims", str(tmp_path / "c.json")]
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit, match="call it set_SEED"):
        exam.main()
    assert not (tmp_path / "out").exists()


def test_a_set_is_added_or_replaced(tmp_path: Path) -> None:
    path = tmp_path / "claims.json"
    keep(path, "22", [(0.97, True), (0.97, False)])
    keep(path, "11", [(0.6, True)])
    keep(path, "22", [(0.9, True), (0.97, True)])
    assert read(path) == {"11": [(0.6, 1, 1)], "22": [(0.97, 1, 1), (0.9, 1, 1)]}
    assert [line[:6] for line in path.read_text(encoding="utf-8").splitlines()] == ["{", '  "11"', '  "22"', "}"]


def test_the_newest_sets_are_added_up_and_no_older_ones() -> None:
    rows = "\n".join(ROW.format(seed) for seed in range(1, SETS + 3))
    claims = {"1": [(0.9, 8, 10)], "2": [(0.6, 1, 2)], str(SETS + 2): [(0.9, 0, 90)]}
    column = newest_sets(f"{HEADS}\n|---|\n{rows}\n", claims)
    assert f"{40 * SETS} cases" in column.head
    first = column.figures["first named cause true"]
    assert first is not None and (first.hits, first.of) == (23 * SETS, 28 * SETS)
    healthy = column.figures["a cause named on a healthy valve"]
    assert healthy is not None and (healthy.hits, healthy.of) == (SETS, 8 * SETS)
    assert column.figures["its stage right"] is None
    error = column.figures["calibration error"]
    assert error is not None and error.value == pytest.approx((10 * 0.1 + 2 * 0.1) / 12)
    assert error.interval.startswith("12 causes")


def test_sets_without_claims_have_no_calibration_error() -> None:
    assert newest_sets(f"{HEADS}\n|---|\n{ROW.format(1)}\n", {}).figures["calibration error"] is None


def test_claims_are_kept_of_all_sets_that_are_added_up() -> None:
    """So that the calibration error is that of the sets which the heading counts."""
    page = (HOUSE / "docs" / "strangers.md").read_text(encoding="utf-8")
    heads, *rows = next(table for table in tables(page) if table[0][0] == "plant")
    seeds = [row[heads.index("seed")] for row in rows[:SETS]]
    kept = json.loads((HOUSE / "docs" / "strangers.json").read_text(encoding="utf-8"))
    assert [seed for seed in seeds if seed not in kept] == []


def test_means_of_several_sets_stand_from_the_least_to_the_largest_and_the_worst_is_held_to_the_target() -> None:
    most, least = (next(m for m in GOALS if m.column == column) for column in ("set", "closure"))
    figures = [one for cell in ("1.2", "1.7", "1.05") if (one := figure(cell))]
    found = spread(most, figures)
    assert found is not None
    assert found.text == "1.05 to 1.7"
    assert most.missed(found)
    small = spread(least, figures)
    assert small is not None
    assert small.value == 1.05
    assert spread(most, []) is None
