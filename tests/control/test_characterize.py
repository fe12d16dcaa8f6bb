"""The two curves from steady dwells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.characterize import Settling, characterize, find_dwells, fit_curve
from tests.control.toy_valve import Toy, record

LEVELS = [*np.arange(4.0, 13.0, 0.35), *np.arange(13.0, 4.0, -0.35)]


def staircase(dwell_s: float = 15.0, period_s: float = 0.2, toy: Toy | None = None):  # type: ignore[no-untyped-def]
    command = np.repeat(LEVELS, round(dwell_s / period_s))
    return record(toy or Toy(), np.arange(command.size) * period_s, command)


def test_a_staircase_gives_both_curves_with_intervals_that_hold() -> None:
    curves = characterize([staircase()], Settling(2.7, 0.3, 0.12))
    assert curves.closing is not None
    assert curves.opening is not None
    assert curves.closing.onset.value == pytest.approx(8.78, abs=0.01)
    assert curves.opening.onset.value == pytest.approx(5.82, abs=0.01)
    assert curves.closing.compliance.value == pytest.approx(0.19, rel=0.01)
    assert curves.opening.compliance.value == pytest.approx(0.19, rel=0.01)
    for curve in (curves.closing, curves.opening):
        assert curve.onset.half_width < 0.02
        assert curve.used.sum() >= 6


def test_separate_slopes_are_told_apart() -> None:
    curves = characterize([staircase(toy=Toy(k1=0.2, k2=0.18))], Settling(2.7, 0.3, 0.12))
    assert curves.closing is not None
    assert curves.opening is not None
    assert curves.closing.compliance.value == pytest.approx(0.2, rel=0.01)
    assert curves.opening.compliance.value == pytest.approx(0.18, rel=0.01)


def test_short_dwells_are_corrected_for_what_is_left_to_move() -> None:
    recording = staircase(dwell_s=11.0)
    plain, corrected = characterize([recording]), characterize([recording], Settling(2.7, 0.3, 0.12))
    assert plain.closing is not None
    assert corrected.closing is not None
    assert abs(corrected.closing.onset.value - 8.78) < abs(plain.closing.onset.value - 8.78)


def test_dwells_are_the_stays_of_the_command() -> None:
    dwells = find_dwells(staircase())
    assert dwells.command == pytest.approx(LEVELS)
    assert dwells.pressure == pytest.approx(LEVELS, abs=0.005)
    assert np.isnan(dwells.moved[0])
    gap = np.zeros(staircase().n, dtype=bool)
    gap[200] = True
    assert np.isnan(find_dwells(replace(staircase(), gap_before=gap)).moved).sum() >= 2


def test_a_ramp_has_no_dwells_and_says_so() -> None:
    time_s = np.arange(0.0, 200.0, 0.2)
    curves = characterize([record(Toy(), time_s, np.linspace(4.0, 13.0, time_s.size))])
    assert curves.closing is None
    assert "no dwells" in curves.notes[0]


def test_a_few_false_points_do_not_pull_the_line() -> None:
    pressure = np.linspace(9.0, 11.5, 12)
    position = 0.19 * (pressure - 8.78)
    position[[2, 7]] += 0.2
    curve = fit_curve(pressure, position)
    assert curve is not None
    assert curve.onset.value == pytest.approx(8.78, abs=1e-3)
    assert curve.used.sum() == 10
    assert fit_curve(np.full(5, 9.0), np.linspace(0.0, 1.0, 5)) is None


def test_dwells_in_which_the_stem_still_moves_are_said_once() -> None:
    curves = characterize([staircase(dwell_s=4.0)], Settling(2.7, 0.3, 0.12))
    assert curves.closing is curves.opening is None
    assert len(curves.notes) == 1
    assert "the stem still moves in all" in curves.notes[0]
