"""Strangers' files: read as they were meant, or refused with the row that is wrong; never silently changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from hal.errors import BadInput
from logs.load import load_recording
from tests.logs.strangers import HEAD, KPA, load, refusal, said


def test_a_plain_file_is_read_without_a_word(tmp_path: Path) -> None:
    recording = load(tmp_path, HEAD + "0,3,3.1,0\n0.1,4,3.4,0.01\n0.2,4,3.7,0.02\n")
    assert recording.time_s.tolist() == [0.0, 0.1, 0.2]
    assert recording.command.tolist() == [3.0, 4.0, 4.0]
    assert recording.pressure is not None and recording.pressure.tolist() == [3.1, 3.4, 3.7]
    assert recording.position.tolist() == [0.0, 0.01, 0.02]
    assert recording.target is None and recording.notes == () and recording.name == "file"
    assert (recording.pressure_unit, recording.position_unit, recording.command_timing) == ("psi", "in", "before")


@pytest.mark.parametrize(
    "text",
    [
        "\ufefft/ms;Command [kPa];P (bar);pos_mm\n0;20,5;0,25;25,4\n# remark\n50;21,5;0,5;12,7\n",
        "% made elsewhere\n\nt/ms\tCommand [kPa]\tP (bar)\tpos_mm\r\n0\t20.5\t0.25\t25.4\r\n50\t21.5\t0.5\t12.7\r\n",
        "t,command,pressure,position\nms,kPa,bar,mm\n0,20.5,0.25,25.4\n50,21.5,0.5,12.7\n",
        '"t ms"|"command kPa"|"pressure bar"|"position mm"\n"0"|"20.5"|"0.25"|"25.4"\n"50"|"21.5"|"0.5"|"12.7"\n',
        "t_ms command_kPa pressure_bar position_mm\n 0   20.5  0.25 25.4\n50   21.5  0.5  12.7\n",
        ";".join(["t [ms]", "command [kPa]", "p [bar]", "x [mm]"]).encode("utf-16") + b"",
    ],
    ids=["semicolon, decimal comma, BOM", "tab, comments, CRLF", "units row", "bar, quotes", "blanks", "utf-16"],
)
def test_one_recording_in_many_spellings(tmp_path: Path, text: str | bytes) -> None:
    if isinstance(text, bytes):
        text = (text.decode("utf-16") + "\n0;20,5;0,25;25,4\n50;21,5;0,5;12,7\n").encode("utf-16")
    recording = load(tmp_path, text)
    assert recording.time_s == pytest.approx([0.0, 0.05])
    assert recording.command == pytest.approx([20.5 * KPA, 21.5 * KPA])
    assert recording.pressure == pytest.approx([25 * KPA, 50 * KPA])
    assert recording.position == pytest.approx([1.0, 0.5])
    assert (recording.pressure_unit, recording.position_unit) == ("psi", "in")
    assert "converted from kPa to psi" in said(recording)


def test_names_and_units_from_the_command_line_win(tmp_path: Path) -> None:
    text = "a,b,c,d,e\n0,20,21,50,51\n1000,21,22,60,61\n2000,21,23,65,61\n"
    mapping = "time=a,command=b,pressure=c,position=d,target=e"
    recording = load(tmp_path, text, mapping=mapping, units="command=kPa,position=percent,time=ms")
    assert recording.time_s.tolist() == [0.0, 1.0, 2.0]
    assert recording.pressure == pytest.approx([21 * KPA, 22 * KPA, 23 * KPA])  # its partner's unit holds for it too
    assert recording.position.tolist() == [50.0, 60.0, 65.0] and recording.position_unit == "percent"
    assert recording.target is not None and recording.target.tolist() == [51.0, 61.0, 61.0]


def test_a_unit_that_nobody_knows_is_refused_with_its_file_and_column(tmp_path: Path) -> None:
    text = "time_s,command (psi),position (furlongz)\n0,5,0.1\n1,5,0.1\n"
    said_why = refusal(tmp_path, text)
    assert "file.csv: column 'position (furlongz)': unit 'furlongz' is not a unit of position" in said_why
    assert "column 'position (furlongz)': unit 's'" in refusal(tmp_path, text, units="position=s")


def test_percent_of_everything(tmp_path: Path) -> None:
    recording = load(tmp_path, "time_s,command_%,pressure (%),position [percent]\n0,10,11,12\n1,20,21,22\n")
    assert recording.pressure_unit == recording.position_unit == "percent"
    assert recording.command.tolist() == [10.0, 20.0]


def test_percent_beside_a_pressure_needs_its_range(tmp_path: Path) -> None:
    text = "time_s,command_%,pressure_kPa,position_%\n0,0,21,0\n1,50,60,10\n2,100,100,20\n"
    assert "--units 'command=percent(3..15 psi)'" in refusal(tmp_path, text)
    recording = load(tmp_path, text, units="command=percent(3..15 psi)")
    assert recording.command == pytest.approx([3.0, 9.0, 15.0])
    assert load(tmp_path, text, mapping="pressure=").pressure is None


def test_a_signal_with_a_range_becomes_a_pressure(tmp_path: Path) -> None:
    text = "time_s,command,position\n0,4,0\n1,12,2.5\n2,20,5\n"
    recording = load(tmp_path, text, units="command=mA(4..20=3..15 psi),position=V(0..5=0..25.4 mm)")
    assert recording.command == pytest.approx([3.0, 9.0, 15.0])
    assert recording.position == pytest.approx([0.0, 0.5, 1.0])


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("", {}, ["empty"]),
        ("nothing\n", {}, ["only one column"]),
        (HEAD, {}, ["no row under the header"]),
        (HEAD + "0,3,3,0\n", {}, ["1 row with a usable time"]),
        (HEAD + "0,3,3,0\n1,4x,3,0\n", {}, ["row 2 (line 3)", "'4x'", "command_psi"]),
        (HEAD + "0,3,3,0\n1,4,3\n2,4,3,0\n", {}, ["line 3", "3 cells", "header has 4"]),
        (HEAD + "0,,3,0\n1,,3,0\n", {}, ["command_psi", "holds no number"]),
        (HEAD + "0,3,3,\n1,4,3,\n", {}, ["position_in", "holds no number"]),
        (HEAD + "5,3,3,0\n5,4,3,0\n", {}, ["every row has the same time"]),
        ("a,b,c\n1,2,3\n2,3,4\n", {}, ["no column for time, command, position", "'a', 'b', 'c'", "--map"]),
        ("1,2,3\n2,3,4\n", {}, ["no header", "--map time=1"]),
        ("time_s,u,command,command\n1,2,3,4\n", {}, ["two columns are called 'command'"]),
        ("time_s,u,cmd,position\n1,2,3,4\n", {}, ["'u', 'cmd' could all be the command"]),
        (HEAD + "0,3,3,0\n1,4,3,0\n", {"mapping": "time=zeit"}, ["time=zeit", "no such column"]),
        (HEAD + "0,3,3,0\n1,4,3,0\n", {"mapping": "tempo=zeit"}, ["tempo=zeit", "not ROLE=VALUE"]),
        (HEAD + "0,3,3,0\n1,4,3,0\n", {"units": "position=furlong3"}, ["furlong3", "not a unit of position"]),
        (HEAD + "0,3,3,0\n1,4,3,0\n", {"units": "command=mm"}, ["'mm'", "not a unit of pressure"]),
        (
            "time,command,position\n2024-01-01 10:00:00,3,0\n2024-13-01 10:00:01,3,0\n",
            {},
            ["row 2 (line 3)", "'2024-13-01 10:00:01'", "is not a time like those above"],
        ),
        (HEAD + '0,3,"3,0\n1,4,3,0\n2,4,3,0\n', {}, ["line 2", "a quote that is not closed"]),
        (b"\x7fELF\x00\x01\x02", {}, ["neither a text file nor Parquet"]),
        (b"PAR1 and then nonsense", {}, ["damaged Parquet"]),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_sentence(
    tmp_path: Path, text: str | bytes, options: dict[str, str], words: list[str]
) -> None:
    message = refusal(tmp_path, text, **options)
    for word in words:
        assert word in message
    assert "\n" not in message


@pytest.mark.parametrize(("column", "kind"), [([{"in": 1.0}] * 3, "struct"), ([[1.0]] * 3, "list")])
def test_a_parquet_column_that_is_no_number_is_refused(tmp_path: Path, column: list[object], kind: str) -> None:
    table = pa.table({"time_s": [0.0, 1.0, 2.0], "command_psi": [3.0, 4.0, 5.0], "position_in": column})
    pq.write_table(table, tmp_path / "odd.parquet")
    with pytest.raises(BadInput, match=f"column 'position_in' holds {kind}"):
        load_recording(tmp_path / "odd.parquet")


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="No such file"):
        load_recording(tmp_path / "none.csv")


def test_a_last_line_cut_off_by_a_crash_is_left_out_and_said(tmp_path: Path) -> None:
    recording = load(tmp_path, HEAD + "0,3,3,0\n1,4,3.2,0.1\n2,4,3.")
    assert recording.n == 2 and "the last line is cut off | left out | 1" in said(recording)


@pytest.mark.parametrize("seed", range(8))
def test_a_spoilt_file_is_read_or_refused_but_never_breaks_the_reader(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = HEAD + "".join(f"{k / 10:.1f},{3 + k % 5},{3.5 + k % 5},{k / 100}\n" for k in range(30))
    bits = ["NaN", "", "inf", "abc", "1e400", ",", ";", "\n", "\t", '"', "#", "\x00", "é", "12:30", "\r", "1,5", " "]
    for _ in range(40):
        text = list(whole)
        for at in rng.integers(0, len(text), rng.integers(1, 4)):
            text[at] = bits[rng.integers(len(bits))]
        (tmp_path / "file.csv").write_bytes("".join(text).encode(["utf-8", "latin-1", "utf-16"][rng.integers(3)]))
        try:
            recording = load_recording(tmp_path / "file.csv")
        except BadInput as error:
            assert "file.csv" in str(error) and "\n" not in str(error)
            continue
        assert np.all(np.diff(recording.time_s) > 0) and np.isfinite(recording.command).all()
        assert recording.n == recording.position.size == recording.command.size


def test_a_file_without_header_is_mapped_by_number(tmp_path: Path) -> None:
    recording = load(tmp_path, "0,9,3,0\n1,9,4,0.1\n", mapping="time=1,command=3,position=4")
    assert recording.command.tolist() == [3.0, 4.0] and recording.position.tolist() == [0.0, 0.1]


def test_a_column_below_a_header_can_be_given_by_its_number(tmp_path: Path) -> None:
    text = "t,回炼油 OP,stem\n0,3,0\n1,4,0.1\n"
    recording = load(tmp_path, text, mapping="time=1,command=2,position=stem")
    assert recording.command.tolist() == [3.0, 4.0] and recording.position.tolist() == [0.0, 0.1]
    assert "no such column" in refusal(tmp_path, text, mapping="time=1,command=4,position=stem")


TITLES = "Evaporator 5\nRows\t3\tmade by hand\n\n"


def test_lines_above_the_header_are_left_out_and_said(tmp_path: Path) -> None:
    rows = "time_s\tcommand_psi\tpressure_psi\tposition_in\n0\t3\t3\t0\n1\t4\t3.5\t0.1\n2\t4\t{}\t0.2\n"
    recording = load(tmp_path, TITLES + rows.format("4"))
    assert recording.n == 3 and "lines above the header | left out | 2" in said(recording)
    assert "row 3 (line 7)" in refusal(tmp_path, TITLES + rows.format("4x"))


def test_short_rows_under_a_header_are_not_taken_for_titles(tmp_path: Path) -> None:
    message = refusal(tmp_path, "time_s,command_psi,position_in\n0,3,3,0\n1,4,3,0.1\n2,4,3,0.2\n")
    assert "line 2 of the file: 4 cells, the header has 3" in message
