"""docs/thesis.md and docs/thesis.json: the thesis line by line next to ours; items are written anew one by one."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from app.gallery.figure import Entry, Number, save
from app.gallery.index import KEYS
from hal.errors import JobFailed

INTRODUCTION = Path(__file__).parent / "introduction.md"


def write(folder: Path, made: Sequence[Entry]) -> None:
    """Writes these items, with their pictures, into thesis.md and thesis.json below `folder`; the others stay."""
    for entry in made:
        save(entry, folder / "pictures")
    numbers = {**(stored_numbers(folder) if (folder / "thesis.json").is_file() else {}), **stored(made)}
    texts = {**sections(folder), **{entry.key: section(entry) for entry in made}}
    in_order = {key: numbers[key] for key in KEYS if key in numbers}
    (folder / "thesis.json").write_text(json.dumps(in_order, indent=1) + "\n", encoding="utf-8")
    page = [INTRODUCTION.read_text(encoding="utf-8"), *(texts[key] for key in KEYS if key in texts)]
    (folder / "thesis.md").write_text("\n".join(page), encoding="utf-8")


def sections(folder: Path) -> dict[str, str]:
    """The items of the stored page, each from its heading to the next; found by their pictures."""
    path = folder / "thesis.md"
    parts = path.read_text(encoding="utf-8").split("\n## ")[1:] if path.is_file() else []
    return {key: f"## {part}" for part in parts for key in KEYS if f"(pictures/thesis-{key}.png)" in part}


def stored_numbers(folder: Path) -> Mapping[str, Mapping[str, float | None]]:
    """The numbers of thesis.json by item and label. Raises: `JobFailed` when it cannot be read."""
    path = folder / "thesis.json"
    try:
        found: Mapping[str, Mapping[str, float | None]] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise JobFailed(f"{path}: cannot be read ({error}); run `lostmotion gallery`") from error
    return found


def stored(made: Sequence[Entry]) -> dict[str, dict[str, float | None]]:
    """Every number by item and label; null where it is not finite."""
    return {e.key: {n.label: n.ours if math.isfinite(n.ours) else None for n in e.numbers} for e in made if e.numbers}


def section(entry: Entry) -> str:
    """The Markdown text of one item."""
    lines = [f"## {entry.title}", ""]
    if entry.said:
        lines += [f"*Thesis:* {entry.said}", ""]
    lines += [f"*Here:* {entry.found}", ""]
    lines += [f"{note}\n" for note in entry.notes]
    if entry.draw is not None:
        lines += [f"![{entry.title}](pictures/{entry.picture})", ""]
    if entry.numbers:
        lines += [*table(entry.numbers), ""]
    if entry.command:
        lines += [f"Run it: `{entry.command}`, `lostmotion thesis {entry.key}`", ""]
    return "\n".join(lines)


def table(numbers: Sequence[Number]) -> list[str]:
    """The lines of a table; labels "row: column" make one with columns."""
    return _pivot(numbers) if any(": " in n.label for n in numbers) else _table(numbers)


def _table(numbers: Sequence[Number]) -> list[str]:
    rows = ["| | thesis | here | |", "|---|---:|---:|---|"]
    for n in numbers:
        said = "" if n.thesis is None else f"{n.thesis:g}"
        rows.append(f"| {n.label} | {said} | {text(n)} | {n.unit} |")
    return rows


def _pivot(numbers: Sequence[Number]) -> list[str]:
    """Labels "row: column" as tables of their own, one for each set of columns; labels without a colon above them."""
    plain = [n for n in numbers if ": " not in n.label]
    tables: list[dict[str, dict[str, Number]]] = []
    for n in numbers:
        if ": " not in n.label:
            continue
        row, column = n.label.split(": ", 1)
        known = (t for t in tables if row in t or any(column in cells for cells in t.values()))
        table = next(known, None)
        if table is None:
            tables.append(table := {})
        table.setdefault(row, {})[column] = n
    lines = [*_table(plain), ""] if plain else []
    for number, table in enumerate(tables):
        lines += [*([""] if number else []), *_pivoted(table)]
    return lines


def _pivoted(table: dict[str, dict[str, Number]]) -> list[str]:
    """One table. A column whose rows differ in unit has the units at the end of the rows; the thesis's numbers stand in
    front."""
    columns = list(dict.fromkeys(column for cells in table.values() for column in cells))
    units = {column: {cells[column].unit for cells in table.values() if column in cells} for column in columns}
    mixed = any(len(each) > 1 for each in units.values())
    said = any(n.thesis is not None for cells in table.values() for n in cells.values())
    head = [c if mixed or units[c] == {""} else f"{c} [{min(units[c])}]" for c in columns]
    head = ["thesis"] * said + head
    rows = [f"| | {' | '.join([*head, *['unit'] * mixed])} |"]
    rows.append("|---|" + "---:|" * len(head) + "---|" * mixed)
    for name, mine in table.items():
        theirs = next((f"{n.thesis:g}" for n in mine.values() if n.thesis is not None), "")
        values = [*[theirs] * said, *(text(mine[c]) if c in mine else "" for c in columns)]
        rows.append(f"| {name} | {' | '.join([*values, *[next(iter(mine.values())).unit] * mixed])} |")
    return rows


def text(n: Number) -> str:
    """Our value as the page shows it."""
    shown = f"{n.ours:.{n.digits}f}" if math.isfinite(n.ours) else n.absent
    return shown.removeprefix("-") if math.isfinite(n.ours) and float(shown) == 0.0 else shown
