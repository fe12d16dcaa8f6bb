from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.blind.pool import RESULTS, read_lines, run_all
from app.blind.trial import Order, orders
from hal.errors import BadInput


def write(out: Path, *texts: str) -> None:
    (out / RESULTS).write_text("".join(texts), encoding="utf-8")


def test_lines_come_by_number_and_the_last_word_counts(tmp_path: Path) -> None:
    write(tmp_path, '{"trial": 2, "x": 1}\n', '{"trial": 0}\n', '{"trial": 2, "x": 5}\n')
    assert read_lines(tmp_path) == [{"trial": 0}, {"trial": 2, "x": 5}]


def test_a_line_cut_off_by_a_crash_is_redone_and_does_not_spoil_the_file(tmp_path: Path) -> None:
    write(tmp_path, '{"trial": 0}\n', '{"trial": 1, "lab')
    assert read_lines(tmp_path) == [{"trial": 0}]
    assert list(run_all([], tmp_path)) == []
    assert (tmp_path / RESULTS).read_text() == '{"trial": 0}\n'


def test_damage_in_the_middle_is_named(tmp_path: Path) -> None:
    write(tmp_path, "nonsense\n", '{"trial": 1}\n')
    with pytest.raises(BadInput, match="line 1"):
        read_lines(tmp_path)


def test_no_results_yet(tmp_path: Path) -> None:
    assert read_lines(tmp_path) == []


def test_a_trial_that_fails_is_a_result(tmp_path: Path) -> None:
    todo = [Order(0, "x", "no such family", tmp_path / "trial")]
    (line,) = run_all(todo, tmp_path, processes=1)
    assert line["trial"] == 0 and "BadInput" in line["error"]
    assert json.loads((tmp_path / RESULTS).read_text()) == line


def test_both_families_take_turns_and_seeds_give_other_valves(tmp_path: Path) -> None:
    made = orders(4, 7, "both", tmp_path)
    assert [order.family for order in made] == ["thesis", "reference", "thesis", "reference"]
    assert len({order.seal for order in (*made, *orders(4, 8, "both", tmp_path))}) == 8
