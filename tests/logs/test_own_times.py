"""Signals with times of their own: a time column before each, or a table with one reading a row."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from logs.load import load_recording
from logs.own_times import at_positions, in_step
from logs.recording import FloatArray
from tests.logs.strangers import load, refusal, said

#: The command changes at 1.5 s; the position is read each second, the pressure at its own times; four rows, five, two.
WIDE = "Time,command_psi,Time,position_in,Time,pressure_psi\n0,3,0,0,0.5,3\n1.5,5,1,0,2.5,5\n,,2,0.1,,\n,,3,0.2,,\n"
TAGS = "tag,timestamp [s],value\nCMD,0,3\nZT,0,0\nPT,0.5,3\nZT,1,0\nCMD,1.5,5\nZT,2,0.1\nPT,2.5,5\nZT,3,0.2\n"
MAP = "command=CMD,position=ZT,pressure=PT"
UNITS = "command=psi,position=in,pressure=psi"


def check(recording: object) -> None:
    assert recording.time_s.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert recording.command.tolist() == [3.0, 3.0, 4.0, 5.0], "half of the second to 2 s it was 3, half 5"
    assert recording.position.tolist() == [0.0, 0.0, 0.1, 0.2]
    np.testing.assert_allclose(recording.pressure, [np.nan, 3.5, 4.5, np.nan])


def test_each_signal_with_a_time_column_before_it_comes_to_the_rows_of_the_position(tmp_path: Path) -> None:
    recording = load(tmp_path, WIDE)
    check(recording)
    assert "each signal has times of its own | brought to the rows of position_in" in said(recording)


def test_one_reading_a_row_is_turned_into_columns(tmp_path: Path) -> None:
    recording = load(tmp_path, TAGS, mapping=MAP, units=UNITS)
    check(recording)
    assert "each signal has times of its own | brought to the rows of ZT" in said(recording)


def test_tags_that_are_not_named_are_listed(tmp_path: Path) -> None:
    message = refusal(tmp_path, TAGS)
    assert "no column for position" in message
    assert "'CMD'" in message and "'ZT'" in message and "--map" in message


def test_dates_are_read_by_one_calendar(tmp_path: Path) -> None:
    begin = datetime(2024, 3, 5, 8, tzinfo=UTC)

    def at(seconds: float) -> str:
        return (begin + timedelta(seconds=seconds)).strftime("%d-%b-%y %H:%M:%S")

    rows = [(at(0), 3, at(1), 0.0), (at(2), 5, at(2), 0.0), ("No Data", "Bad", at(3), 0.1)]
    text = "".join(",".join(map(str, row)) + "\n" for row in rows)
    recording = load(tmp_path, "Timestamp,command_psi,Timestamp,position_in\n" + text)
    assert np.diff(recording.time_s).tolist() == [1.0, 1.0]
    assert recording.command.tolist() == [3.0, 3.0, 5.0]


def test_a_parquet_files_dates_are_read_by_one_calendar(tmp_path: Path) -> None:
    begin = datetime(2024, 3, 5, 8, tzinfo=UTC)
    when = [begin + timedelta(seconds=s) for s in range(4)]
    columns = {
        "time": pa.array([when[0], when[2], None, None]),
        "command_psi": pa.array([3.0, 5.0, None, None]),
        "time.1": pa.array(when),
        "position_in": pa.array([0.0, 0.0, 0.1, 0.2]),
    }
    parquet.write_table(pa.table(columns), tmp_path / "r.parquet")
    recording = load_recording(tmp_path / "r.parquet")
    assert np.diff(recording.time_s).tolist() == [1.0, 1.0, 1.0]
    assert recording.command.tolist() == [3.0, 3.0, 3.0, 5.0], "5 from 2 s on: in force after that row's reading"


def test_times_that_go_alike_are_one_clock(tmp_path: Path) -> None:
    rows = "0,3,0,0\n1,5,1,0\n2,5,2,0.1\n"
    recording = load(tmp_path, "X_Value,command_psi,X_Value,position_in\n" + rows)
    assert recording.command.tolist() == [3.0, 5.0, 5.0], "a row's command, as in any other file"
    assert "times of its own" not in said(recording)


def test_clocks_that_pass_midnight_do_so_each_in_its_row(tmp_path: Path) -> None:
    rows = (
        "23:59:57,3,23:59:58,0\n23:59:58,3,23:59:59,0\n00:00:00,5,00:00:00,0\n00:00:03,5,00:00:01,0.1\n,,00:00:02,0.2\n"
    )
    recording = load(tmp_path, "Time,command_psi,Time,position_in\n" + rows)
    assert np.diff(recording.time_s).tolist() == [1.0] * 4
    assert recording.command.tolist() == [3.0, 3.0, 3.0, 5.0, 5.0]
    assert "the time counter ran over" in said(recording)


def test_a_signal_without_any_time_is_refused_in_a_sentence(tmp_path: Path) -> None:
    message = refusal(tmp_path, "Time,command_psi,Time,position_in\n,3,0,0\n,4,1,0.1\n")
    assert "command" in message and "holds no number" in message
    assert "usable time" in refusal(tmp_path, "Time,command_psi,Time,position_in\n,3,,0\n,4,,0.1\n")


def test_one_time_that_is_chosen_is_that_of_all_rows(tmp_path: Path) -> None:
    rows = "0,3,0.5,0\n1,5,1.25,0\n2,5,2.5,0.1\n"
    recording = load(tmp_path, "Time,command_psi,Time,position_in\n" + rows, mapping="time=Time")
    assert recording.time_s.tolist() == [0.0, 1.0, 2.0]
    assert recording.command.tolist() == [3.0, 5.0, 5.0]


def test_times_in_two_units_are_refused(tmp_path: Path) -> None:
    rows = "0,3,0,0\n1500,5,1,0\n"
    message = refusal(tmp_path, "Time [ms],command_psi,Time.1 [s],position_in\n" + rows)
    assert "'Time [ms]' and 'Time.1 [s]' are not written alike" in message


def test_two_other_columns_of_one_name_are_refused_still(tmp_path: Path) -> None:
    assert "two columns are called 'lvdt'" in refusal(tmp_path, "time,command_psi,lvdt,lvdt\n0,3,0,0\n1,3,0,0\n")


def test_nothing_is_known_before_the_first_command(tmp_path: Path) -> None:
    found = at_positions(
        {"command": np.array([5.0, np.nan]), "position": np.arange(2.0)},
        {"command": np.array([1.5, np.nan]), "position": np.array([1.0, 2.0])},
    )
    np.testing.assert_array_equal(found["command"], [np.nan, 5.0])


TIMES = st.lists(st.floats(0.0, 50.0), min_size=1, max_size=12, unique=True).map(lambda some: np.sort(np.array(some)))


@given(at=TIMES, seed=st.integers(0, 2**32 - 1))
def test_commands_keep_their_work_over_any_rows(at: FloatArray, seed: int) -> None:
    """Held values have the same integral over the rows as they had in time, however the rows lie."""
    chance = np.random.default_rng(seed)
    when = np.unique(np.concatenate([at[:1], at[0] + np.cumsum(chance.uniform(0.1, 5.0, 20))]))
    told = chance.uniform(3.0, 15.0, at.size)
    found = at_positions({"command": told, "position": when}, {"command": at, "position": when})["command"]
    ends = np.append(at[1:], np.inf)
    held = sum(v * max(min(e, when[-1]) - b, 0.0) for v, b, e in zip(told, at, ends, strict=True))
    assert float(np.sum(found[1:] * np.diff(when))) == pytest.approx(held)
    assert np.all((found >= told.min() - 1e-9) & (found <= told.max() + 1e-9))


def test_clocks_are_in_step_where_they_are_apart_by_a_constant() -> None:
    first = np.array([0.0, 1.0, 2.5, np.nan])
    assert in_step({"command": first, "position": first + 3.0})
    assert not in_step({"command": first, "position": first * 1.01})
    assert not in_step({"command": first, "position": np.array([0.0, 1.0, np.nan, np.nan])})
