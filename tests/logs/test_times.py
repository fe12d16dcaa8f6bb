"""Time columns: what is unwrapped, spread and merged, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from hal.errors import BadInput
from logs.assemble import row_name
from logs.times import ascending, gaps, merge_doubles, unwrap


@pytest.mark.parametrize(("modulus", "unit_s"), [(2.0**16, 1e-3), (2.0**32, 1e-3), (86_400.0, 1.0), (86_400e3, 1e-3)])
def test_a_counter_that_ran_over_twice_is_unwrapped(modulus: float, unit_s: float) -> None:
    truth = modulus - 30.0 + np.arange(0.0, modulus * 1.5 + 100.0, max(10.0, modulus / 50_000))
    raw, notes = unwrap(truth % modulus, unit_s)
    assert np.allclose(np.diff(raw), np.diff(truth)) and notes[0].rows == 2


def test_a_clock_that_was_set_back_is_not_taken_for_a_counter() -> None:
    raw = np.array([0.0, 10.0, 20.0, 15.0, 25.0])
    same, notes = unwrap(raw, 1.0)
    assert same is raw and notes == []
    with pytest.raises(BadInput, match=r"here: row 4: the time goes backward, from 20 s to 15 s"):
        ascending(raw, "here", row_name)


def test_a_file_that_is_newest_first_is_turned_round() -> None:
    when = ascending(np.array([30.0, 20.0, np.nan, 10.0, 0.0]), "here", row_name)
    assert when.time_s.tolist() == [0.0, 10.0, 20.0, 30.0] and when.keep.tolist() == [4, 3, 1, 0]
    assert "rows stand newest first" in [note.what for note in when.notes]


def test_times_of_day_that_run_backward_over_midnight_are_refused_not_unwrapped() -> None:
    falling = (86_400.0 - 60.0 * np.arange(1.0, 4000.0)) % 86_400.0
    same, notes = unwrap(falling, 1.0)
    assert same is falling and notes == []
    with pytest.raises(BadInput, match="row 2: the time goes backward"):
        ascending(falling, "here", row_name)


def test_rows_merge_by_mean_or_by_first_and_nan_does_not_count() -> None:
    time_s = np.array([0.0, 0.0, 1.0, 2.0, 2.0])
    values = np.array([1.0, 3.0, 5.0, np.nan, 7.0])
    assert merge_doubles(time_s, values, average=True).tolist() == [2.0, 5.0, 7.0]
    assert merge_doubles(time_s, values, average=False)[:2].tolist() == [1.0, 5.0]


def test_only_intervals_with_samples_missing_are_gaps() -> None:
    assert np.flatnonzero(gaps(np.array([0.0, 1.0, 2.6, 3.6, 4.6, 6.5, 7.5]))).tolist() == [5]
    assert not gaps(np.array([0.0, 9.0])).any()


def test_one_row_is_no_recording() -> None:
    with pytest.raises(BadInput, match="at least 2"):
        ascending(np.array([np.nan, 1.0]), "here", row_name)
