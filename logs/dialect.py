"""How a text file of numbers is written: encoding, comments, separator, decimal sign, header, units row."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hal.errors import BadInput

SEPARATORS = (";", "\t", ",", "|")
MISSING = ("", "nan", "NaN", "NAN", "na", "NA", "N/A", "n/a", "#N/A", "#NV", "null", "NULL", "None", "-", "--", "?")
_COMMENT = re.compile(rb"(?m)^[ \t]*(?:#|%|//)[^\n]*(?:\n|\Z)")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+|\d+,\d*|,\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity)", re.IGNORECASE)
_HEAD_BYTES = 65_536


@dataclass(frozen=True, slots=True)
class Dialect:
    """`headers` are made up ("1", "2", ...) when `has_header` is False; `units_row` is empty where there is none.

    `titles` lines stand above the header: the name of the plant, the date, the number of rows.
    """

    separator: str
    decimal: str
    headers: tuple[str, ...]
    has_header: bool
    units_row: tuple[str, ...] = ()
    titles: int = 0

    @property
    def skipped_rows(self) -> int:
        """Rows at the top of the cleaned text that are not samples."""
        return self.titles + int(self.has_header) + int(bool(self.units_row))


def clean(data: bytes, where: str) -> bytes:
    """UTF-8 text without byte order mark, comment lines and stray carriage returns.

    Raises: `BadInput` for a file that is no text.
    """
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        data = data.decode("utf-16", errors="replace").encode()
    data = data.removeprefix(b"\xef\xbb\xbf")
    if b"\0" in data[:_HEAD_BYTES]:
        raise BadInput(f"{where}: this is neither a text file nor Parquet; export it as CSV")
    try:
        data[:_HEAD_BYTES].decode()
    except UnicodeDecodeError as error:
        if error.end < len(data[:_HEAD_BYTES]) - 3:  # not just a character cut in two: an 8-bit code page
            data = data.decode("latin-1").encode()
    if b"\r" in data[:_HEAD_BYTES] and b"\n" not in data[:_HEAD_BYTES]:
        data = data.replace(b"\r", b"\n")
    if re.search(rb"(?m)^[ \t]*(?:#|%|//)", data):
        data = _COMMENT.sub(b"", data)
    return data.lstrip(b"\r\n \t")


def sniff(text: bytes, where: str) -> Dialect:
    """Finds out how cleaned `text` is written, from its first lines.

    Raises: `BadInput` when it holds nothing, or only one column.
    """
    lines = [line for line in text[:_HEAD_BYTES].decode(errors="replace").splitlines() if line.strip()][:40]
    if len(text) > _HEAD_BYTES and len(lines) > 2:
        lines = lines[:-1]  # the last one may have been cut
    if not lines:
        raise BadInput(f"{where}: the file is empty; a recording needs a header line and rows of numbers")
    separator = _separator(lines)
    cells = [split(line, separator) for line in lines]
    titles = _titles(cells)
    del cells[:titles]
    if len(cells[0]) < 2:
        raise BadInput(f"{where}: only one column found ('{lines[0][:60]}'); separate columns by comma, ; or tab")
    has_header = not all(_is_number(cell) for cell in cells[0])
    headers = cells[0] if has_header else [str(number + 1) for number in range(len(cells[0]))]
    units_row = cells[1] if has_header and len(cells) > 1 and _is_units_row(cells[1]) else []
    return Dialect(separator, _decimal(text, separator), tuple(headers), has_header, tuple(units_row), titles)


def _titles(cells: list[list[str]]) -> int:
    """How many lines stand above the header: those before the first one that is as wide as the samples are.

    Only where that line is a header, without a number in it: rows that are too short must be named, not skipped.
    """
    widths = [len(line) for line in cells]
    width = max(set(widths), key=widths.count)
    first = widths.index(width)
    if width < 2 or widths.count(width) < 3 or any(_NUMBER.fullmatch(cell) for cell in cells[first]):
        return 0
    return first


def split(line: str, separator: str) -> list[str]:
    """The cells of a line, without quotes and blanks around them."""
    if separator == " ":
        return line.split()
    cells = re.findall(rf'(?:^|{re.escape(separator)})("(?:[^"]|"")*"|[^{re.escape(separator)}]*)', line.rstrip("\r"))
    return [cell.strip().strip('"').strip() for cell in cells]


def _separator(lines: list[str]) -> str:
    """The separator that cuts most lines into the same number of cells, and into most cells."""

    def merit(separator: str) -> tuple[int, int]:
        counts = [len(split(line, separator)) for line in lines]
        width = max(set(counts[1:] or counts), key=(counts[1:] or counts).count)
        return (sum(count == width for count in counts), width) if width > 1 else (0, 0)

    # A decimal comma makes the comma look like a separator too; the others come first and win a draw.
    best = max(SEPARATORS, key=merit)
    for separator in SEPARATORS[:2]:
        if merit(separator)[0] >= len(lines) - 1 > 0:
            best = separator
            break
    if merit(best) == (0, 0) and merit(" ")[1] > 1:
        return " "
    return best


def _decimal(text: bytes, separator: str) -> str:
    """The comma, where whole cells are numbers with a comma and none is one with a point. Dates do not count."""
    if separator == ",":
        return "."
    mark = rb"[ \t]" if separator == " " else re.escape(separator).encode()
    cell = rb'(?m)(?:^|%b)[ "]*[-+]?\d*%b\d+(?:[eE][-+]?\d+)?[ "]*(?:%b|\r?$)'
    commas, points = (re.search(cell % (mark, sign, mark), text) for sign in (b",", rb"\."))
    return "," if commas and not points else "."


def _is_number(cell: str) -> bool:
    return cell in MISSING or _NUMBER.fullmatch(cell) is not None


def _is_units_row(cells: list[str]) -> bool:
    """A row of words under the header, none of them a number or a time of day: LabVIEW and friends write units so."""
    words = [cell for cell in cells if cell]
    return bool(words) and not any(re.search(r"\d[\d:.,-]*", cell) or _NUMBER.fullmatch(cell) for cell in words)
