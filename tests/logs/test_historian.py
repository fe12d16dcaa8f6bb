"""A plant's historian writes words where it has no value: they are missing values, and said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from logs.load import load_recording
from tests.logs.strangers import HEAD, load, refusal, said

ROWS = "0,3,3,0\n1,3,Bad Input,0.1\n2,Shutdown,3.2,I/O Timeout\n3,5,4,0.3\n4,5,BAD INPUT,0.3\n"


def test_words_of_a_historian_are_missing_values_and_said(tmp_path: Path) -> None:
    recording = load(tmp_path, HEAD + ROWS)
    assert recording.command.tolist() == [3.0, 3.0, 3.0, 5.0, 5.0]
    assert recording.pressure is not None and np.isnan(recording.pressure).tolist() == [False, True, False, False, True]
    assert np.isnan(recording.position).tolist() == [False, False, True, False, False]
    words = said(recording)
    assert "pressure_psi: 'Bad Input' in place of a value | taken as missing | 1 | 2" in words
    assert "pressure_psi: 'BAD INPUT' in place of a value | taken as missing | 1 | 5" in words
    assert "command_psi: 'Shutdown' in place of a value | taken as missing | 1 | 3" in words
    assert "command_psi: missing values | the last command is held | 1 | 3" in words
    assert "position_in: 'I/O Timeout' in place of a value | taken as missing | 1 | 3" in words


def test_they_are_read_beside_decimal_commas_and_in_a_parquet_file(tmp_path: Path) -> None:
    commas = HEAD.replace(",", ";") + "0;3,5;3,5;0\n1;3,5;No Data;0,25\n2;4;4;0,5\n"
    recording = load(tmp_path, commas)
    assert recording.command.tolist() == [3.5, 3.5, 4.0] and recording.position.tolist() == [0.0, 0.25, 0.5]
    assert recording.pressure is not None and np.isnan(recording.pressure).tolist() == [False, True, False]
    table = pa.table(
        {"time_s": [0.0, 1.0, 2.0], "command_psi": [3.0, 4.0, 4.0], "position_in": ["0", "Pt Created", "0.2"]}
    )
    for text in (pa.string(), pa.large_string()):
        parquet.write_table(table.set_column(2, "position_in", table["position_in"].cast(text)), tmp_path / "r.parquet")
        recording = load_recording(tmp_path / "r.parquet")
        assert np.isnan(recording.position).tolist() == [False, True, False]
        assert "position_in: 'Pt Created' in place of a value | taken as missing | 1 | 2" in said(recording)


def test_a_word_for_the_first_time_hides_no_calendar(tmp_path: Path) -> None:
    rows = "No Data,3,0\n05-Mar-24 08:00:00,3,0\n05-Mar-24 08:00:01,4,0.1\n"
    recording = load(tmp_path, "time [ms],command_psi,position_in\n" + rows)
    assert np.diff(recording.time_s) == pytest.approx([1.0]), "dates are seconds, whatever the header says"
    assert "rows without a usable time | left out" in said(recording)


def test_any_other_word_is_refused_still(tmp_path: Path) -> None:
    message = refusal(tmp_path, HEAD + "0,3,3,0\n1,3,about three,0.1\n2,4,4,0.2\n")
    assert "row 2 (line 3): 'about three' in column 'pressure_psi' is not a number" in message
