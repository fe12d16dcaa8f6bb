"""Sketches in text."""

from __future__ import annotations

import numpy as np
import pytest

from control.preview import duration_words, sketch, with_scale


def test_a_ramp_runs_from_bottom_left_to_top_right() -> None:
    lines = sketch(np.linspace(0.0, 1.0, 200), columns=10, rows=4)
    assert [len(line) for line in lines] == [10] * 4
    assert lines[0][-1] != "\u2800"
    assert lines[0][0] == "\u2800"
    assert lines[-1][0] != "\u2800"
    assert lines[-1][-1] == "\u2800"


def test_a_jump_is_a_stroke_without_holes() -> None:
    lines = sketch(np.repeat([0.0, 1.0], 50), columns=10, rows=4)
    assert all(any(cell != "\u2800" for cell in line[4:6]) for line in lines)


def test_constant_and_missing_values_are_drawn_too() -> None:
    assert len(sketch(np.full(5, 3.0), columns=4, rows=2)) == 2
    values = np.array([1.0, np.nan, 2.0, np.nan])
    assert with_scale(values, "psi", columns=4, rows=2)[0].startswith("2 psi")


@pytest.mark.parametrize(("seconds", "words"), [(45.0, "45 s"), (1100.0, "18 min 20 s"), (7500.0, "2 h 05 min")])
def test_times_in_words(seconds: float, words: str) -> None:
    assert duration_words(seconds) == words
