"""Where in a text file something is wrong: looked up only when there is something to say."""

from __future__ import annotations

import re

from hal.errors import BadInput
from logs.dialect import Dialect, split


def check_quotes(data: bytes, dialect: Dialect, where: str) -> None:
    """A quote that is never closed swallows the rows after it; that must not pass in silence.

    Raises: `BadInput` with the line.
    """
    if b'"' not in data or dialect.separator == " ":
        return
    odd = [number for number, line in sample_lines(data, dialect) if line.count('"') % 2]
    if odd:
        raise BadInput(f"{where}: line {odd[0]} of the file: a quote that is not closed; correct the line")


def why_not(message: str, data: bytes, dialect: Dialect) -> str:
    """The reader's complaint, with the line of the file in place of its own count."""
    wrong = re.search(r"Row #(\d+): Expected (\d+) columns, got (\d+)", message)
    expected = len(dialect.headers)
    for number, line in sample_lines(data, dialect):
        cells = len(split(line, dialect.separator))
        if cells != expected:
            return f"line {number} of the file: {cells} cells, the header has {expected} ('{line[:60]}'); correct it"
    first = message.partition("\n")[0][:120]
    return f"row {wrong[1]}: {first}" if wrong else first


def line_of(data: bytes, row: int, dialect: Dialect) -> str:
    for count, (number, _) in enumerate(sample_lines(data, dialect)):
        if count == row:
            return f"row {row + 1} (line {number})"
    return f"row {row + 1}"


def sample_lines(data: bytes, dialect: Dialect) -> list[tuple[int, str]]:
    """Line number in the file and text of every row of samples; only used to explain an error."""
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8"
    lines = re.split(r"\r\n|\n|\r", data.decode(encoding, errors="replace"))
    kept = [
        (number + 1, line)
        for number, line in enumerate(lines)
        if line.strip() and not re.match(r"[ \t\ufeff]*(#|%|//)", line)
    ]
    return kept[dialect.skipped_rows :]
