from __future__ import annotations

from app.blind.score import score
from app.blind.strength import STRATA
from app.blind.table import curve_rows, fault_rows, number, rows
from tests.app.blind.lines import some_lines


def test_figures_stand_with_their_intervals() -> None:
    found = {what: (figure, interval) for what, figure, interval in rows(score(some_lines())["all"])}
    assert found["all right: every cause and no other"] == ("3 of 6  50 %", "19 to 81 %")
    assert found["  one wrong number"] == ("-", "")


def test_faults_as_right_noticed_trials() -> None:
    cells = {row[0]: row[1:] for row in fault_rows(score(some_lines())["all"], STRATA)}
    assert cells["creep"] == ["0/0/1", "", "1/1/1", ""]
    assert cells["dead_time"] == ["", "", "", "0/1/1"]


def test_what_is_not_known_is_a_dash() -> None:
    assert number(None) == number(float("nan")) == "-" and number(0.12345) == "0.123"


def test_the_calibration_error_stands_beside_that_of_chance() -> None:
    group = score(some_lines())["all"]
    found = {what: (figure, interval) for what, figure, interval in rows(group)}
    figure, interval = found["  by chance, were every probability true"]
    assert 0.0 < float(figure) < 1.0 and " to " in interval
    claims = sum(int(row[1]) for row in curve_rows(group["calibration"]["curve"]))
    assert claims == group["calibration"]["claims"] > 0
