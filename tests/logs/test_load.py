"""Strangers' files: read as they were meant, or refused with the row that is wrong; never silently changed."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hal.errors import BadInput
from logs.export import write_csv, write_parquet
from logs.load import load_recording
from logs.open import open_record
from logs.recording import Recording
from logs.run import read_run
from tests.logs.runs import UNITS, valve_columns, write_run

HEAD = "time_s,command_psi,pressure_psi,position_in\n"
KPA = 0.145037737730


def load(tmp_path: Path, text: str | bytes, **options: str) -> Recording:
    path = tmp_path / "file.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_recording(path, **options)  # type: ignore[arg-type]


def refusal(tmp_path: Path, text: str | bytes, **options: str) -> str:
    with pytest.raises(BadInput) as caught:
        load(tmp_path, text, **options)
    return str(caught.value)


def said(recording: Recording) -> str:
    return "\n".join(f"{note.what} | {note.handled} | {note.rows} | {note.first_row}" for note in recording.notes)


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


def test_a_clipped_signal_is_named(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    time_s = np.arange(400) * 0.1
    position = np.minimum(0.3 + 0.2 * np.sin(time_s / 4) + 0.001 * rng.standard_normal(400), 0.45)
    rows = "".join(f"{t:.2f},{3 + t / 9:.4f},{3 + t / 9:.4f},{x:.6f}\n" for t, x in zip(time_s, position, strict=True))
    assert "position_in: flat at its highest value 0.45" in said(load(tmp_path, HEAD + rows))


def test_commands_that_take_effect_after_their_row_move_to_the_row_after(tmp_path: Path) -> None:
    text = HEAD + "0,3,3,0\n1,4,3,0.1\n2,5,4,0.2\n"
    after = load(tmp_path, text, command_timing="after")
    assert after.command.tolist() == [3.0, 3.0, 4.0] and after.command_timing == "before"
    assert load(tmp_path, text, command_timing="unknown").command_timing == "unknown"


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("", {}, ["empty"]),
        ("nothing\n", {}, ["only one column"]),
        (HEAD, {}, ["no row under the header"]),
        (HEAD + "0,3,3,0\n", {}, ["1 rows have a usable time"]),
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


def test_a_run_its_csv_and_its_parquet_are_one_recording(tmp_path: Path) -> None:
    columns = valve_columns(300)
    columns["position_in"][7] = np.nan
    write_run(tmp_path / "run", columns)
    run = read_run(tmp_path / "run")
    write_csv(run, tmp_path / "run.csv")
    write_parquet(run, tmp_path / "run.parquet")
    recordings = [load_recording(tmp_path / name) for name in ("run", "run.csv", "run.parquet", "run/run.json")]
    for recording in recordings:
        assert np.array_equal(recording.time_s, columns["time_s"])
        assert np.array_equal(recording.command, columns["command_psi"])
        assert np.array_equal(recording.position, columns["position_in"], equal_nan=True)
        assert recording.pressure is not None and np.array_equal(recording.pressure, columns["pressure_psi"])
        assert [note.rows for note in recording.notes if "missing" in note.what] == [1]
    assert recordings[0].meta["status"] == "success"


def test_a_run_says_what_its_bench_flagged(tmp_path: Path) -> None:
    columns = valve_columns(100)
    columns["quality"][40:43] = 1.0
    write_run(tmp_path / "run", columns)
    words = said(load_recording(tmp_path / "run"))
    assert "quality: readings flagged stale by the bench | kept as it is | 3 | 41" in words


def test_a_positioners_record_leaves_the_pressure_out(tmp_path: Path) -> None:
    columns = valve_columns(100)
    columns["command_percent"] = columns.pop("command_psi")
    write_run(tmp_path / "run", columns, units={name: UNITS.get(name, "percent") for name in columns})
    recording = load_recording(tmp_path / "run")
    assert recording.pressure is None and recording.pressure_unit == "percent"
    assert "a position in percent" in said(recording)


def test_a_folder_that_is_no_run_and_options_that_do_not_apply(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"without run\.json"):
        load_recording(tmp_path)
    write_run(tmp_path / "run", valve_columns(20))
    with pytest.raises(BadInput, match="leave out --map and --units"):
        load_recording(tmp_path / "run", units="time=ms")


def test_a_strangers_file_opens_as_a_run(tmp_path: Path) -> None:
    (tmp_path / "file.csv").write_text("time_ms,command_kPa,position_%\n0,20,1\n100,21,2\n")
    run = open_record(tmp_path / "file.csv")
    assert list(run.columns) == ["time_s", "command_psi", "position_percent"]
    assert run.rows == 2 and run.status == "success" and run.kind == "imported"


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-1e6, 1e6, allow_subnormal=False), min_size=2, max_size=40))
def test_any_numbers_survive_export_and_load(tmp_path_factory: pytest.TempPathFactory, values: list[float]) -> None:
    path = tmp_path_factory.mktemp("any") / "x.csv"
    lines = [f"{k * 0.1!r},3.0,{value!r}" for k, value in enumerate(values)]
    path.write_text("time_s,command_psi,position_in\n" + "\n".join(lines) + "\n")
    assert np.array_equal(load_recording(path).position, np.array(values))


def test_many_rows_in_little_time(tmp_path: Path) -> None:
    rows = 100_000
    path = tmp_path / "long.csv"
    block = "".join(f"{{t}}{k % 10},{3 + k % 7},{3 + k % 11 / 3:.4f},{k % 13 / 50:.4f}\n" for k in range(10))
    path.write_text(HEAD + "".join(block.replace("{t}", f"{k}.") for k in range(rows // 10)))
    begin = time.process_time()
    assert load_recording(path).n == rows
    assert time.process_time() - begin < 5.0  # measured 0.1 s; a loop over rows in Python would take longer than 5
