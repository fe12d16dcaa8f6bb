"""docs/thesis.md and docs/thesis.json: the thesis line by line next to ours, and the check that they are not stale."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from app.gallery.figure import Entry, Number, save
from app.gallery.index import KEYS, make
from hal.errors import JobFailed

INTRODUCTION = Path(__file__).parent / "introduction.md"


def entries() -> Iterator[Entry]:
    """Every item of the gallery, computed now."""
    yield from map(make, KEYS)


def write(folder: Path, made: Sequence[Entry]) -> None:
    """Writes thesis.md, thesis.json and the pictures below `folder`."""
    for entry in made:
        save(entry, folder / "pictures")
    (folder / "thesis.json").write_text(json.dumps(stored(made), indent=1) + "\n", encoding="utf-8")
    (folder / "thesis.md").write_text(page(made), encoding="utf-8")


def stored(made: Sequence[Entry]) -> dict[str, dict[str, float | None]]:
    """Every number by item and label; null where it is not finite."""
    return {e.key: {n.label: n.ours if math.isfinite(n.ours) else None for n in e.numbers} for e in made if e.numbers}


def page(made: Sequence[Entry]) -> str:
    """The Markdown text."""
    return "\n".join([INTRODUCTION.read_text(encoding="utf-8"), *(_section(entry) for entry in made)])


def _section(entry: Entry) -> str:
    lines = [f"## {entry.title}", ""]
    if entry.said:
        lines += [f"*Thesis:* {entry.said}", ""]
    lines += [f"*Here:* {entry.found}", ""]
    lines += [f"{note}\n" for note in entry.notes]
    if entry.draw is not None:
        lines += [f"![{entry.title}](pictures/{entry.picture})", ""]
    if entry.numbers:
        lines += [*(_pivot(entry.numbers) if len(entry.numbers) > 10 else _table(entry.numbers)), ""]
    if entry.command:
        lines += [f"Run it: `{entry.command}`, `lostmotion thesis {entry.key}`", ""]
    return "\n".join(lines)


def _table(numbers: Sequence[Number]) -> list[str]:
    rows = ["| | thesis | here | |", "|---|---:|---:|---|"]
    for n in numbers:
        said = "" if n.thesis is None else f"{n.thesis:g}"
        rows.append(f"| {n.label} | {said} | {text(n)} | {n.unit} |")
    return rows


def _pivot(numbers: Sequence[Number]) -> list[str]:
    """Labels "row: column" as a table of their own; labels without a colon above it."""
    plain = [n for n in numbers if ": " not in n.label]
    cells = {tuple(n.label.split(": ", 1)): n for n in numbers if ": " in n.label}
    columns = list(dict.fromkeys(column for _, column in cells))
    units = {column: n.unit for (_, column), n in cells.items()}
    head = " | ".join(f"{c} [{units[c]}]" if units[c] else c for c in columns)
    rows = [*([*_table(plain), ""] if plain else []), f"| | {head} |", "|---|" + "---:|" * len(columns)]
    for name in dict.fromkeys(row for row, _ in cells):
        values = (text(cells[(name, c)]) if (name, c) in cells else "" for c in columns)
        rows.append(f"| {name} | {' | '.join(values)} |")
    return rows


def text(n: Number) -> str:
    """Our value as the page shows it."""
    return f"{n.ours:.{n.digits}f}" if math.isfinite(n.ours) else "-"


def check(folder: Path, made: Sequence[Entry]) -> None:
    """Compares numbers computed now with those stored.

    Raises: `JobFailed` with every number that has moved by more than a unit of its last digit shown and 2 %.
    """
    old = json.loads((folder / "thesis.json").read_text(encoding="utf-8"))
    moved = []
    for entry in made:
        for n in entry.numbers:
            was = old.get(entry.key, {}).get(n.label, "missing")
            if was is None and not math.isfinite(n.ours):
                continue
            if not isinstance(was, float | int) or abs(was - n.ours) > max(10.0**-n.digits, 0.02 * abs(n.ours)):
                moved.append(f"{entry.key} {n.label}: {was} -> {n.ours:.4g}")
    if moved:
        raise JobFailed(f"docs/thesis.md is stale; run `lostmotion gallery`: {'; '.join(moved)}")
