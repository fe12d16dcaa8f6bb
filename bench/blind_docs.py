"""Publishes blind checks: `python bench/blind_docs.py [CHECK...] [--ablations DIR] [--crime FILE]`.

Each CHECK is the folder of a finished `lostmotion blind`. It becomes a page of its own, docs/blind/seed-SEED.md, which
is never written again; remarks are added to it by hand. Then the summary in docs/blind.md and the table in the README
are made anew from all pages (and from docs/strangers.md); without a CHECK, only that is done.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from app.blind.page import confusion_matrix
from app.blind.pool import read_lines
from app.blind.score import score
from app.blind.strength import STRATA
from app.blind.table import curve_rows, fault_rows, number, rows
from bench.blind_pages import CURVE, published
from bench.blind_readme import readme
from bench.blind_summary import summary, table
from bench.exam_claims import read

HOUSE = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- generated: python bench/blind_docs.py -->", "<!-- end of the generated part -->"


def committed(commit: str) -> str:
    """When a commit was made, to the minute [UTC]. Raises: `CalledProcessError` when git does not know it."""
    words = ["git", "-C", str(HOUSE), "show", "--no-patch", "--format=%ct", commit.removesuffix("-dirty")]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    return datetime.fromtimestamp(int(said), UTC).strftime("%Y-%m-%d %H:%M")


def publish(folder: Path, house: Path = HOUSE, when: Callable[[str], str] = committed) -> Path:
    """Writes the page of a check and gives its path.

    Raises: `SystemExit` when that check is published, or was not run from a checkout of git.
    """
    protocol = json.loads((folder / "protocol.json").read_text(encoding="utf-8"))
    page = house / "docs" / "blind" / f"seed-{protocol['seed']}.md"
    if page.exists():
        raise SystemExit(f"{page}: a published check is not written again; delete it first if it was never published")
    if not protocol["git"]:
        raise SystemExit(f"{folder}: protocol.json names no commit, so nobody could repeat this check")
    page.write_text("\n".join(section(folder, protocol, when(protocol["git"]))).rstrip() + "\n", encoding="utf-8")
    return page


def between(text: str, new: str) -> str:
    """The text with another generated part. Raises: `ValueError` when the markers are not there once each."""
    head, rest = text.split(BEGIN)
    _, tail = rest.split(END)
    return f"{head}{BEGIN}\n\n{new.strip()}\n\n{END}{tail}"


def renewed(house: Path = HOUSE) -> dict[Path, str]:
    """docs/blind.md and the README as the pages say that they should be."""
    checks = published(house / "docs" / "blind")
    strangers = (house / "docs" / "strangers.md").read_text(encoding="utf-8")
    claims = read(house / "docs" / "strangers.json")
    parts = {house / "docs" / "blind.md": summary(checks), house / "README.md": readme(checks, strangers, claims)}
    return {path: between(path.read_text(encoding="utf-8"), part) for path, part in parts.items()}


def section(folder: Path, protocol: dict[str, Any], code: str) -> Iterator[str]:
    """A check as Markdown: where it comes from, figures, confusion, faults, everything that went wrong."""
    lines = read_lines(folder)
    scores = score(lines)
    yield f"# Seed {protocol['seed']}, family {protocol['family']}: {scores['trials']} trials\n"
    yield (
        f"Code of {code} UTC; [all published checks](../blind.md#results), "
        "[how it is counted](../blind.md#how-it-is-counted).\n"
    )
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
    heads = ["", *(head for name in tables for head in (name, "95 % interval"))]
    what = next(iter(tables.values()))
    yield from table(heads, ([name, *(cell for of in tables.values() for cell in of[name])] for name in what))
    yield "## What the probabilities were worth\n\nOf all causes named, also for faults below the floor.\n"
    yield from table(CURVE, curve_rows(scores["all"]["calibration"]["curve"]))
    yield "## What was answered\n\nRows: the truth (single faults at or above the floor). Cells: answer and count.\n"
    matrix = confusion_matrix(scores["all"]["confusion"])
    yield from table(["truth", "right", "otherwise"], (_answers(t, c, matrix["said"]) for t, c in matrix["rows"]))
    yield "## Fault by fault\n\nRight / noticed / trials, by size against the floor.\n"
    yield from table(["fault", *(f"{s} x" for s in STRATA)], fault_rows(scores["all"], STRATA))
    yield "## Every miss\n"
    yield from table(["trial", "family", "x floor", "truth", "answer"], (_miss(x) for x in lines if _missed(x)))


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

    made = []
    for name in ABLATIONS:
        path = folder / f"{name.replace(' ', '-')}.jsonl"
        if path.is_file():
            made.append(row(name, [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()]))
    yield from table(["taken away", "all right", "first cause true", "false cause on a healthy valve", "broken"], made)


def crime(path: Path) -> Iterator[str]:
    """What the diagnosis scores on records that its own equations made."""
    from bench.inverse_crime import table_rows

    lines = [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()]
    yield from table(["", "figure", "95 % interval"], table_rows(lines))


def with_table(text: str, heading: str, lines: Iterator[str]) -> str:
    """The document with another first table below a heading; words around it stay. Raises: `ValueError` without it."""
    before, found, after = text.partition(f"\n{heading}\n")
    if not found:
        raise ValueError(f"docs/blind.md has no heading {heading!r}")
    new = "\n".join(lines).rstrip() + "\n"
    return before + found + re.sub(r"(?:^\|.*\n)+", lambda _: new, after, count=1, flags=re.MULTILINE)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checks", nargs="*", type=Path)
    parser.add_argument("--ablations", type=Path)
    parser.add_argument("--crime", type=Path)
    asked = parser.parse_args()
    for folder in asked.checks:
        print(f"wrote {publish(folder)}")
    document = HOUSE / "docs" / "blind.md"
    made = {"## Ablations": ablations(asked.ablations)} if asked.ablations else {}
    made |= {"## Inverse crime, for contrast only": crime(asked.crime)} if asked.crime else {}
    for heading, lines in made.items():
        document.write_text(with_table(document.read_text(encoding="utf-8"), heading, lines), encoding="utf-8")
    for path, text in renewed().items():
        path.write_text(text, encoding="utf-8")
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
