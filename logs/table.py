"""A stranger's table read into arrays: CSV in its many spellings, Parquet, Arrow; says which row is wrong."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hal.errors import BadInput
from logs.calendar_text import EPOCH_S, FORMS, looks_like_time, parser_of
from logs.dialect import MISSING, Dialect, clean, sniff, split
from logs.historian import is_state
from logs.recording import DataNote, FloatArray
from logs.roles import is_clock, split_header
from logs.rows import check_quotes, line_of, why_not


@dataclass(frozen=True, slots=True)
class Table:
    """A file whose columns are converted when they are asked for.

    `number(header)` gives float64, NaN where a cell is empty; times of day and dates become seconds.
    Row r of the arrays is row r + 1 for people. `header_units` come from a units row or from Parquet field metadata.
    """

    where: str
    headers: tuple[str, ...]
    rows: int
    column: Callable[[str], Any]
    locate: Callable[[int], str]
    has_header: bool = True
    header_units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[DataNote, ...] = ()

    def number(self, header: str, since_first: bool = True) -> FloatArray:
        """Raises: `BadInput` with line, column and cell for the first cell that is no number.

        Dates of the file's own kind are seconds since the first row, or since 2000, as those that are text.
        """
        import pyarrow as pa

        array = self.column(header)
        if pa.types.is_temporal(array.type):
            return _seconds(array, since_first)
        if pa.types.is_null(array.type):
            return np.full(len(array), np.nan)
        if pa.types.is_string(array.type) or pa.types.is_large_string(array.type):
            return self._parsed(header, array)
        try:
            return np.asarray(array.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False), dtype=np.float64)
        except pa.ArrowException as error:
            raise BadInput(f"{self.where}: column '{header}' holds {array.type}; it must hold numbers") from error

    def states(self, header: str) -> dict[str, tuple[int, int]]:
        """What a historian says in place of values: of each word how often, and in which row first, from 1."""
        import pyarrow as pa

        array, found = self.column(header), dict[str, tuple[int, int]]()
        if not (pa.types.is_string(array.type) or pa.types.is_large_string(array.type)):
            return found
        for row, cell in enumerate(array.to_pylist()):
            if is_state(text := (cell or "").strip()):
                count, first = found.get(text, (0, row + 1))
                found[text] = (count + 1, first)
        return found

    def is_calendar(self, header: str) -> bool:
        """Whether a column holds dates or times of day, which become seconds by themselves."""
        import pyarrow as pa

        array = self.column(header)
        if pa.types.is_string(array.type):  # one cell that is no date makes text of them all
            return parser_of(next((text for text in map(_text, array.to_pylist()) if text), "")) is not float
        return bool(pa.types.is_temporal(array.type))

    def _parsed(self, header: str, array: Any) -> FloatArray:
        """A column that came as text because of a cell or two: the missing ones are NaN, anything else is refused."""
        values = np.full(len(array), np.nan)
        parse: Callable[[str], float] | None = None
        for row, cell in enumerate(array.to_pylist()):
            if not (text := _text(cell)):
                continue
            parse = parse or parser_of(text)
            try:
                values[row] = parse(text)
            except ValueError as error:
                shown = text.partition("\n")[0][:40]
                kind = "a number" if parse is float else "a time like those above it"
                advice = "correct the cell, or leave it empty where the value is missing"
                if parse is float and looks_like_time(text):
                    advice = f"times are read as {FORMS}"
                raise BadInput(
                    f"{self.where}: {self.locate(row)}: '{shown}' in column '{header}' is not {kind}; {advice}"
                ) from error
        return values


def _text(cell: str | None) -> str:
    """What a cell says, "" where that is that there is no value."""
    text = (cell or "").strip()
    return "" if text in MISSING or is_state(text) else text


def read_table(path: Path) -> Table:
    """Opens a CSV, Parquet or Arrow file.

    Raises: `BadInput` with the file, and the line where there is one, when it cannot be read as a table.
    """
    try:
        with path.open("rb") as file:
            magic = file.read(6)
            rest = b"" if magic[:4] == b"PAR1" or magic == b"ARROW1" else magic + file.read()
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({error.strerror}); check the path") from error
    if rest or not magic:
        return _read_csv(path, rest)
    return _read_arrow(path, parquet=magic[:4] == b"PAR1")


def _read_csv(path: Path, data: bytes) -> Table:
    import pyarrow as pa
    from pyarrow import csv

    where = str(path)
    text = clean(data, where)
    dialect = sniff(text, where)
    if dialect.separator == " ":
        text = re.sub(rb"[ \t]+", b" ", re.sub(rb"(?m)^[ \t]+|[ \t\r]+$", b"", text))
    names = _unique(dialect.headers, where)
    check_quotes(data, dialect, where)
    text, notes = _without_torn_tail(text, dialect)
    if dialect.titles:
        notes = (DataNote("lines above the header", "left out", dialect.titles), *notes)
    try:
        table = csv.read_csv(
            io.BytesIO(_body(text, dialect.skipped_rows)),
            read_options=csv.ReadOptions(column_names=list(names), block_size=1 << 23),
            parse_options=csv.ParseOptions(delimiter=dialect.separator),
            convert_options=csv.ConvertOptions(
                null_values=list(MISSING), strings_can_be_null=True, decimal_point=dialect.decimal
            ),
        )
    except pa.ArrowInvalid as error:
        raise BadInput(f"{where}: {why_not(str(error), data, dialect)}") from error
    if table.num_rows == 0:
        raise BadInput(f"{where}: there is no row under the header; a recording needs at least 2")
    units = dict(zip(names, dialect.units_row, strict=False))
    return Table(
        where=where,
        headers=names,
        rows=table.num_rows,
        column=lambda header: _retyped(table.column(header), dialect.decimal),
        locate=lambda row: line_of(data, row, dialect),
        has_header=dialect.has_header,
        header_units={name: unit.strip("[]() ") for name, unit in units.items()},
        notes=notes,
    )


def _without_torn_tail(text: bytes, dialect: Dialect) -> tuple[bytes, tuple[DataNote, ...]]:
    """Leaves out a last line that was cut off while it was written: no line end, and cells missing."""
    body, newline, tail = text.rpartition(b"\n")
    if not newline or not tail.strip():
        return text, ()
    cells = split(tail.decode(errors="replace"), dialect.separator)
    if len(cells) >= len(dialect.headers):
        return text, ()
    return body + newline, (DataNote("the last line is cut off", "left out", 1),)


def _retyped(array: Any, decimal: str) -> Any:
    """A text column whose numbers are written with a comma or padded with blanks, so that they can be parsed."""
    import pyarrow as pa
    from pyarrow import compute

    if not pa.types.is_string(array.type):
        return array
    trimmed = compute.utf8_trim_whitespace(array)
    return compute.replace_substring(trimmed, ",", ".") if decimal == "," else trimmed


def _read_arrow(path: Path, parquet: bool) -> Table:
    import pyarrow as pa
    from pyarrow import feather
    from pyarrow import parquet as pq

    try:
        table = pq.read_table(path) if parquet else feather.read_table(path)
    except (pa.ArrowInvalid, OSError) as error:
        kind = "Parquet" if parquet else "Arrow"
        raise BadInput(f"{path}: a damaged {kind} file ({str(error).splitlines()[0]}); write it again") from error
    if table.num_rows == 0:
        raise BadInput(f"{path}: the table has no rows; a recording needs at least 2")
    units = {each.name: (each.metadata or {}).get(b"unit", b"").decode() for each in table.schema}
    return Table(
        where=str(path),
        headers=_unique(table.column_names, str(path)),
        rows=table.num_rows,
        column=table.column,
        locate=lambda row: f"row {row + 1}",
        header_units=units,
    )


def _seconds(array: Any, since_first: bool) -> FloatArray:
    """Dates or times of day as seconds; dates from the first row on (float64 keeps microseconds then), or from 2000."""
    import pyarrow as pa

    unit_s = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}.get(getattr(array.type, "unit", ""), 86_400.0)
    wide = array.cast(pa.int32() if array.type.bit_width == 32 else pa.int64()).cast(pa.int64())
    first = 0
    if not pa.types.is_time(array.type):
        first = next((value.as_py() for value in wide if value.is_valid), 0)
        first = first if since_first else round(EPOCH_S / unit_s)
    counts = np.asarray(wide.to_numpy(zero_copy_only=False), dtype=np.float64) if wide.null_count else None
    if counts is None:
        return np.asarray((wide.to_numpy(zero_copy_only=False) - first) * unit_s, dtype=np.float64)
    return np.asarray((counts - first) * unit_s, dtype=np.float64)


def _body(text: bytes, skipped: int) -> bytes:
    """The text below its first `skipped` non-blank lines."""
    start = 0
    while skipped > 0:
        end = text.find(b"\n", start)
        if end < 0:
            return b"\n"
        skipped -= bool(text[start:end].strip())
        start = end + 1
    return text[start:] or b"\n"


def _is_clock(header: str) -> bool:
    return is_clock(split_header(header, "time").label)


def _unique(headers: Sequence[str], where: str) -> tuple[str, ...]:
    """Empty headers get their number, and times behind the first; two others of one name would make it a guess."""
    named = [header or f"column {number + 1}" for number, header in enumerate(headers)]
    named = [f"{h} #{named[:k].count(h) + 1}" if h in named[:k] and _is_clock(h) else h for k, h in enumerate(named)]
    twice = sorted({header for header in named if named.count(header) > 1})
    if twice:
        raise BadInput(f"{where}: two columns are called '{twice[0]}'; rename one of them")
    return tuple(named)
