"""Steps, and what a play remembers of them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.step import Step, Tone, turning_points


def play(values: list[float], half: float, state: float = 0.0) -> float:
    for value in values:
        state = max(value - half, min(value + half, state))
    return state


def test_a_step_goes_straight_and_then_stays() -> None:
    step = Step(4.0, 6.0, rise_s=10.0, hold_s=5.0)
    assert [step.at(t) for t in (0.0, 5.0, 10.0, 14.0)] == [4.0, 5.0, 6.0, 6.0]
    assert step.ticks(0.1) == 150
    assert step.range() == (4.0, 6.0)


def test_a_jump_is_at_its_end_at_once() -> None:
    assert Step(4.0, 6.0, hold_s=1.0).at(0.0) == 6.0


def test_tones_ride_on_the_step() -> None:
    step = Step(8.0, 8.0, hold_s=4.0, tones=(Tone(0.25, 2.0, 0.0),))
    assert step.at(1.0) == pytest.approx(10.0)
    assert step.range() == (6.0, 10.0)


@given(st.lists(st.floats(0.0, 10.0), min_size=1, max_size=30), st.floats(0.0, 5.0))
def test_turning_points_leave_any_play_where_the_whole_path_leaves_it(values: list[float], half: float) -> None:
    start = -20.0  # saturated: both paths begin from the same forgotten past
    whole = play([start, *values], half, start)
    assert play([start, *turning_points(values)], half, start) == pytest.approx(whole)


def test_small_swings_inside_later_large_ones_are_forgotten() -> None:
    assert turning_points([4.0, 9.0, 8.0, 8.5, 12.0, 6.0, 7.0]) == [12.0, 6.0, 7.0]
