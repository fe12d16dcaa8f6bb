from __future__ import annotations

import re

from app.blind.page import confusion_matrix, render
from app.blind.score import score
from tests.app.blind.lines import some_lines

PROTOCOL = {"seed": 1, "family": "both", "code": "c" * 64, "git": None, "version": "0"}


def test_the_page_shows_every_trial_and_refers_to_nothing_outside() -> None:
    lines = some_lines()
    text = render(score(lines), lines, PROTOCOL)
    assert text.count('class="wrong">wrong') == 4 and text.count('class="right">right') == 3
    assert "WireFault: no reply" in text
    assert not re.search(r'(src|href)="|https?://', text)


def test_the_matrix_knows_what_each_truth_should_have_been_called() -> None:
    matrix = confusion_matrix(score(some_lines())["all"]["confusion"])
    rows = {truth: dict(zip(matrix["said"], cells, strict=True)) for truth, cells in matrix["rows"]}
    assert rows["none"]["no_gap"] == (1, True) and rows["none"]["creep"] == (1, False)
    assert rows["outsider"]["unexplained"] == (1, True)
    assert rows["creep"]["creep"] == (1, True) and rows["creep"]["sensor_lag"] == (0, False)


def test_a_check_without_a_finished_trial_has_a_page() -> None:
    assert "Blind check: 0 sealed valves" in render(score([]), [], PROTOCOL)
