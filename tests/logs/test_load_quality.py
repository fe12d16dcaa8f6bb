"""Times, gaps, missing and clipped values of strangers' files: handled, and said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.logs.strangers import HEAD, load, refusal, said


def test_dates_and_times_of_day_become_seconds(tmp_path: Path) -> None:
    dates = "timestamp,command_psi,position_in\n2024-01-01 23:59:59.5,3,0\n2024-01-02 00:00:00.25,4,0.1\n"
    assert load(tmp_path, dates).time_s == pytest.approx([0.0, 0.75])
    clock = "time,command_psi,position_in\n23:59:58,3,0\n23:59:59,4,0.1\n00:00:00,4,0.2\n00:00:01,4,0.2\n"
    recording = load(tmp_path, clock)
    assert np.diff(recording.time_s) == pytest.approx([1.0, 1.0, 1.0])
    assert "ran over" in said(recording)
    fine = "time,command_psi,position_in\n10:00:59.9,3,0\n10:01:00.15,4,0.1\n"
    assert load(tmp_path, fine).time_s == pytest.approx([36_059.9, 36_060.15])
    spoilt = "time,command_psi,position_in\n2024-01-01 10:00:00.5,3,0\n,3,0\n2024-01-01 10:00:01,4,0.1\n"
    assert np.diff(load(tmp_path, spoilt).time_s) == pytest.approx([0.5])
    dotted = "Zeit;command_psi;position_in\n31.01.2024 23:59:59,5;3;0\n01.02.2024 00:00:00,25;4,5;0,1\n"
    recording = load(tmp_path, dotted, mapping="time=Zeit")
    assert np.diff(recording.time_s) == pytest.approx([0.75]) and recording.command.tolist() == [3.0, 4.5]
    zone = "time,command_psi,position_in\n2024-01-01T10:00:00.5+02:00,3,0\n2024-01-01T10:00:01+02:00,4,0.1\n"
    assert load(tmp_path, zone).time_s == pytest.approx([0.0, 0.5])


def test_missing_values_are_noted_and_kept_or_held(tmp_path: Path) -> None:
    recording = load(tmp_path, HEAD + "0,3,3,0\n1,,NaN,0.1\n2,inf,-inf,\n3,5,4,0.3\n4,5,5,0.3\n")
    assert recording.command.tolist() == [3.0, 3.0, 3.0, 5.0, 5.0]
    assert recording.pressure is not None and np.isnan(recording.pressure).tolist() == [False, True, True, False, False]
    assert np.isnan(recording.position).tolist() == [False, False, True, False, False]
    words = said(recording)
    assert "command_psi: missing values | the last command is held | 2 | 2" in words
    assert "pressure_psi: missing values, 1 of them infinite | kept as missing | 2 | 2" in words
    assert "position_in: missing values | kept as missing | 1 | 3" in words


def test_a_row_without_a_time_leaves_a_marked_gap(tmp_path: Path) -> None:
    recording = load(tmp_path, HEAD + "0,3,3,0\n1,3,3.1,0.1\n,4,3.2,0.2\n3,5,4,0.3\n4,5,5,0.3\n5,5,5,0.3\n")
    assert recording.time_s.tolist() == [0.0, 1.0, 3.0, 4.0, 5.0]
    assert recording.gap_before is not None and recording.gap_before.tolist() == [False, False, True, False, False]
    assert "rows without a usable time | left out; the gap is marked | 1 | 3" in said(recording)


def test_a_backward_time_is_refused_with_its_row(tmp_path: Path) -> None:
    message = refusal(tmp_path, "# made by hand\n" + HEAD + "0,3,3,0\n0.2,3,3,0\n0.1,4,3,0\n")
    assert "file.csv: row 3 (line 5): the time goes backward, from 0.2 s to 0.1 s" in message


def test_repeated_times_are_averaged_where_few_and_spread_where_many(tmp_path: Path) -> None:
    rows = "".join(f"{t},{3 + t},{3 + t},{t / 10}\n" for t in range(8))
    few = load(tmp_path, HEAD + "0,3,2,0.5\n" + rows)
    assert few.n == 8 and few.position[0] == pytest.approx(0.25) and few.pressure is not None
    assert few.pressure[0] == pytest.approx(2.5)
    assert "rows with the time of the row before | averaged into one row | 1 | 2" in said(few)
    many = load(tmp_path, HEAD + "".join(f"{k // 4},3,{3 + k / 10},{k / 100}\n" for k in range(12)))
    assert np.diff(many.time_s) == pytest.approx(np.full(11, 0.25))
    assert many.n == 12 and "spread evenly" in said(many)


def test_gaps_and_jitter_are_said(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    time_s = np.arange(200) * 0.1 + 0.02 * rng.random(200)
    time_s[120:] += 4.0
    rows = "".join(f"{t:.5f},{3 + k / 100},{3 + k / 101},{k / 1000}\n" for k, t in enumerate(time_s))
    recording = load(tmp_path, HEAD + rows)
    assert recording.gap_before is not None and np.flatnonzero(recording.gap_before).tolist() == [120]
    assert "gaps in time, the longest 4." in said(recording) and "uneven sampling" in said(recording)


def test_a_pressure_that_never_moves_is_no_measurement(tmp_path: Path) -> None:
    stuck = load(tmp_path, HEAD + "0,3,7,0\n1,4,7,0.1\n2,5,7,0.2\n")
    assert stuck.pressure is None and "constant at 7 while the command moves | treated as not measured" in said(stuck)
    empty = load(tmp_path, HEAD + "0,3,,0\n1,4,,0.1\n2,5,,0.2\n")
    assert empty.pressure is None and "no number in it" in said(empty)
    still = load(tmp_path, HEAD + "0,7,7,0\n1,7,7,0.1\n2,7,7,0.2\n")  # so is the command: it may well be true
    assert still.pressure is not None and "command_psi: constant at 7" in said(still)
    in_bar = load(tmp_path, "time_s,command_bar,position_mm\n0,0.7,0\n1,0.7,2\n2,0.7,2\n")
    assert "command_bar: constant at 0.7" in said(in_bar)


def test_a_clipped_signal_is_named(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    time_s = np.arange(400) * 0.1
    position = np.minimum(0.3 + 0.2 * np.sin(time_s / 4) + 0.001 * rng.standard_normal(400), 0.45)
    rows = "".join(f"{t:.2f},{3 + t / 9:.4f},{3 + t / 9:.4f},{x:.6f}\n" for t, x in zip(time_s, position, strict=True))
    assert "position_in: flat at its highest value 0.45" in said(load(tmp_path, HEAD + rows))
    in_mm = load(tmp_path, HEAD.replace("position_in", "position_mm") + rows)
    assert "position_mm: flat at its highest value 0.45" in said(in_mm)  # what stands under that header


def test_commands_that_take_effect_after_their_row_move_to_the_row_after(tmp_path: Path) -> None:
    text = HEAD + "0,3,3,0\n1,4,3,0.1\n2,5,4,0.2\n"
    after = load(tmp_path, text, command_timing="after")
    assert after.command.tolist() == [3.0, 3.0, 4.0] and after.command_timing == "before"
    assert load(tmp_path, text, command_timing="unknown").command_timing == "unknown"


def test_american_dates_are_read_and_a_slash_that_could_be_either_is_refused(tmp_path: Path) -> None:
    rows = "time,command_psi,position_in\n03/05/2024 {0},5,0\n03/05/2024 {1},5,0.1\n"
    noon = rows.format("11:59:59.500000 AM", "12:00:00.250000 PM")
    assert np.diff(load(tmp_path, noon).time_s) == pytest.approx([0.75])
    midnight = rows.format("12:00:00 AM", "01:00:00 AM")
    assert np.diff(load(tmp_path, midnight).time_s) == pytest.approx([3600.0])
    words = refusal(tmp_path, rows.format("11:59:59", "12:00:00"))
    assert "times are read as 2024-03-05 08:00:00.5" in words
    assert "03/05/2024 08:00:00 AM (month first)" in words
