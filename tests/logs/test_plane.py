"""The plane's arithmetic: ticks, design curves, directions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from logs.plane import by_direction, design_curves, nice_ticks


@given(st.floats(-1e4, 1e4), st.floats(1e-3, 1e4))
def test_ticks_are_inside_even_and_few(low: float, span: float) -> None:
    ticks = nice_ticks(low, low + span)
    assert 3 <= len(ticks) <= 12
    assert all(low - 1e-6 * span <= tick <= low + span * (1 + 1e-6) for tick in ticks)
    assert np.allclose(np.diff(ticks), ticks[1] - ticks[0], rtol=1e-6, atol=1e-9)


def test_the_design_curves_pass_through_the_thesis_points() -> None:
    numbers = {"a1": 8.78, "a2": 5.82, "compliance": 0.19, "travel": 0.5625}
    curves = design_curves(numbers)
    assert curves is not None
    assert curves["closing"][1].tolist() == [8.78, 0.0] and curves["opening"][1].tolist() == [5.82, 0.0]
    assert curves["closing"][2] == pytest.approx([8.78 + 0.5625 / 0.19, 0.5625])
    nested = design_curves({"valve": numbers})
    assert nested is not None and np.array_equal(nested["closing"], curves["closing"])


@pytest.mark.parametrize("design", [{}, {"a1": 1.0}, {"valve": 3}, {"a1": "x", "a2": 1, "compliance": 1, "travel": 1}])
def test_a_design_without_its_numbers_draws_nothing(design: dict[str, object]) -> None:
    assert design_curves(design) is None


def test_a_path_is_cut_where_the_command_turns() -> None:
    points = np.column_stack((np.arange(7.0), np.arange(7.0)))
    pieces = by_direction(points, np.array([3.0, 4.0, 4.0, 5.0, 5.0, 4.0, 3.0]))
    assert [len(piece) for piece in pieces["rising"]] == [5] and [len(piece) for piece in pieces["falling"]] == [3]
    assert pieces["rising"][0][-1].tolist() == pieces["falling"][0][0].tolist()
    assert by_direction(points[:1], np.zeros(1)) == {"rising": [], "falling": []}
