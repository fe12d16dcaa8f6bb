"""Writes the generated part of docs/blind.md: `python bench/blind_docs.py CHECK... [--ablations DIR] [--crime FILE]`.

Each CHECK is the folder of a finished `lostmotion blind`. What is made anew comes first; sections of other checks stay
below it as they are, because a published check is never rewritten. The text around the markers is written by hand.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from app.blind.page import confusion_matrix
from app.blind.pool import read_lines
from app.blind.score import score
from app.blind.strength import STRATA
from app.blind.table import fault_rows, number, rows

DOCUMENT = Path(__file__).resolve().parents[1] / "docs" / "blind.md"
BEGIN, END = "<!-- generated: python bench/blind_docs.py -->", "<!-- end of the generated part -->"


def section(folder: Path) -> Iterator[str]:
    """A check as Markdown: where it comes from, figures, confusion, faults, everything that went wrong."""
    protocol = json.loads((folder / "protocol.json").read_text(encoding="utf-8"))
    lines = read_lines(folder)
    scores = score(lines)
    yield f"## Seed {protocol['seed']}, family {protocol['family']}: {scores['trials']} trials\n"
    yield f"Code frozen at commit `{protocol['git']}`, digest `{protocol['code'][:16]}`. Again, from the same commit:\n"
    command = f"lostmotion blind --trials {scores['trials']} --seed {protocol['seed']} --family {protocol['family']}"
    yield f"    {command}\n"
    sealed = len(protocol["commitments"])
    if sealed > scores["trials"]:
        yield (
            f"Of {sealed} that were sealed before the first one ran, {scores['trials']} are shown: all that were done\n"
            "when time was up. Nothing was changed in between, and no trial was left out.\n"
        )
    if scores["broken"]:
        yield f"{len(scores['broken'])} trials ended in an error and are in no figure: {scores['broken']}\n"
    groups = {"all": scores["all"]} | (scores["families"] if len(scores["families"]) > 1 else {})
    tables = {name: {what: cells for what, *cells in _unique(rows(group))} for name, group in groups.items()}
    heads = [f"{name} | 95 % interval" for name in tables]
    yield from table(
        ["", *heads],
        ([what, *(" | ".join(tables[name][what]) for name in tables)] for what in tables["all"]),
        len(tables),
    )
    yield "### What was answered\n\nRows: the truth (single faults at or above the floor). Cells: answer and count.\n"
    matrix = confusion_matrix(scores["all"]["confusion"])
    yield from table(["truth", "right", "otherwise"], (_answers(t, c, matrix["said"]) for t, c in matrix["rows"]))
    yield "### Fault by fault\n\nRight / noticed / trials, by size against the floor.\n"
    yield from table(["fault", *(f"{s} x" for s in STRATA)], fault_rows(scores["all"], STRATA))
    yield "### Every miss\n"
    yield from table(["trial", "family", "x floor", "truth", "answer"], (_miss(x) for x in lines if _missed(x)))


def table(heads: list[str], cells: Iterable[list[str]], wide: int = 0) -> Iterator[str]:
    """Lines of a Markdown table; `wide` columns are double ones."""
    yield f"| {' | '.join(heads)} |"
    yield "|---" * (len(heads) + wide) + "|"
    for row in cells:
        yield f"| {' | '.join(row)} |"
    yield ""


def _unique(found: list[tuple[str, str, str]]) -> Iterator[tuple[str, str, str]]:
    """Indented rows with what they belong to, so that every row has a name of its own."""
    head = ""
    for what, figure, interval in found:
        head = head if what.startswith(" ") else what.partition(":")[0]
        yield (f"{head}: {what.strip()}" if what.startswith(" ") else what), figure, interval


def _answers(truth: str, cells: list[tuple[int, bool]], said: list[str]) -> list[str]:
    right = sum(count for count, hit in cells if hit)
    wrong = [f"{name} {count}" for name, (count, hit) in zip(said, cells, strict=True) if count and not hit]
    return [truth, str(right), ", ".join(wrong)]


def _missed(line: dict[str, Any]) -> bool:
    return "error" not in line and not line["mark"]["right"]


def _miss(line: dict[str, Any]) -> list[str]:
    label = line["label"]
    truth = " + ".join(f"{c['name']} ({c['form']}) {number(c['size'])} {c['unit']}" for c in label["causes"])
    kind = "outsider: " if label["kind"] == "outsider" else ""
    causes = ", ".join(f"{c['name']} {c['probability']:.2f}" for c in line["causes"])
    return [
        str(line["trial"]),
        label["family"],
        number(line["ratio"]),
        kind + (truth or "none"),
        causes or line["verdict"],
    ]


def ablations(folder: Path) -> Iterator[str]:
    """The table that bench/ablations.py prints, out of its files."""
    from bench.ablations import ABLATIONS, row

    yield "## Ablations\n"
    made = []
    for name in ABLATIONS:
        path = folder / f"{name.replace(' ', '-')}.jsonl"
        if path.is_file():
            made.append(row(name, [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()]))
    yield from table(["taken away", "all right", "first cause true", "false cause on a healthy valve", "broken"], made)


def crime(path: Path) -> Iterator[str]:
    """What the diagnosis scores on records that its own equations made."""
    from bench.inverse_crime import table_rows

    yield "## Inverse crime, for contrast only\n"
    yield (
        "Records simulated with the very code and forms that the candidates use, with white noise "
        "(`python bench/inverse_crime.py`). No figure of this table says anything about a valve; the distance to the "
        "tables above is what not knowing the truth costs.\n"
    )
    lines = [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()]
    yield from table(["", "figure", "95 % interval"], table_rows(lines))


def kept(old: str, new: list[str]) -> list[str]:
    """The sections of the generated part that are not made anew."""
    sections = ["## " + part for part in old.split("\n## ")[1:]]
    made = {part.split("\n")[0].partition(",")[0] for part in new}
    return [part for part in sections if part.split("\n")[0].partition(",")[0] not in made]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checks", nargs="+", type=Path)
    parser.add_argument("--ablations", type=Path)
    parser.add_argument("--crime", type=Path)
    asked = parser.parse_args()
    text = DOCUMENT.read_text(encoding="utf-8")
    head, tail = text.split(BEGIN)[0], text.split(END)[1]
    parts = ["\n".join(section(folder)) for folder in asked.checks]
    parts += ["\n".join(ablations(asked.ablations))] if asked.ablations else []
    parts += ["\n".join(crime(asked.crime))] if asked.crime else []
    parts += kept(text.split(BEGIN)[1].split(END)[0], parts)
    DOCUMENT.write_text("\n\n".join([head + BEGIN, *(part.strip() for part in parts), END]) + tail, encoding="utf-8")
    print(f"wrote {DOCUMENT}")


if __name__ == "__main__":
    main()
