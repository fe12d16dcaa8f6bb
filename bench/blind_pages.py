"""Published blind checks, read back from their pages in docs/blind: the one source of every table over them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from app.interval import wilson

HEADING = re.compile(r"^# Seed (\d+), family (\w+): (\d+) trials$", re.MULTILINE)
CODE = re.compile(r"^Code of (\d{4}-\d\d-\d\d \d\d:\d\d) UTC;", re.MULTILINE)
CURVE = ("probability", "causes named", "said, mean", "true", "95 % interval")
COMMIT = re.compile(r"^Code frozen at commit `([^`]+)`", re.MULTILINE)


@dataclass(frozen=True)
class Figure:
    """A count of trials or a number as it stands in a table; `interval` is '' where none was published."""

    text: str
    value: float
    hits: int = 0
    of: int = 0
    interval: str = ""


@dataclass(frozen=True)
class Worth:
    """Causes named with a probability within a range: what was said in the mean, and how many of them were true."""

    span: str
    said: float
    true: Figure


@dataclass(frozen=True)
class Check:
    """A published check; `code` is when its commit was made [UTC], `figures` go by group of valves and row.

    `worth`: what its probabilities were worth, empty where the page does not say.
    """

    seed: int
    family: str
    trials: int
    code: str
    commit: str
    figures: Mapping[str, Mapping[str, Figure]]
    worth: tuple[Worth, ...] = ()


def count(hits: int, of: int) -> Figure:
    """A count with its share and Wilson's interval, both in whole percent."""
    low, high = wilson(hits, of)
    interval = f"{100.0 * low:.0f} to {100.0 * high:.0f} %" if of else ""
    text = f"{hits} of {of}, {100.0 * hits / of:.0f} %" if of else "-"
    return Figure(text, hits / of if of else float("nan"), hits, of, interval)


def added(figures: Iterable[Figure | None]) -> Figure:
    """Counts added up; what is no count, or is not there, adds nothing."""
    counts = [one for one in figures if one]
    return count(sum(one.hits for one in counts), sum(one.of for one in counts))


def figure(cell: str, interval: str = "") -> Figure | None:
    """What a cell says: `42 of 46  91 %`, `0.0675` or `0.996  (n = 49)`; None for a dash."""
    if found := re.match(r"(\d+) of (\d+)\b", cell):
        return count(int(found[1]), int(found[2]))
    if cell in ("", "-"):
        return None
    number = cell.split(maxsplit=1)[0]
    return Figure(number, float(number), interval=interval)


def tables(text: str) -> Iterator[list[list[str]]]:
    """The Markdown tables of a page as rows of cells, the heads first."""
    for block in re.findall(r"(?:^\|.*\n)+", text + "\n", re.MULTILINE):
        lines = [[cell.strip() for cell in line.strip()[1:-1].split("|")] for line in block.splitlines()]
        yield [lines[0], *lines[2:]]


def read(page: Path) -> Check:
    """A check from its page. Raises: `ValueError` naming the page, when it is none."""
    text = page.read_text(encoding="utf-8")
    heading, code, commit = HEADING.search(text), CODE.search(text), COMMIT.search(text)
    if not (heading and code and commit):
        raise ValueError(f"{page}: no heading, time or commit of a blind check")
    if page.name != f"seed-{heading[1]}.md":
        raise ValueError(f"{page}: is about seed {heading[1]}")
    heads, *lines = next(tables(text))
    found = {
        group: {row[0]: number for row in lines if (number := figure(row[place], row[place + 1]))}
        for place, group in enumerate(heads)
        if group and group != "95 % interval"
    }
    return Check(int(heading[1]), heading[2], int(heading[3]), code[1], commit[1], found, tuple(_worth(text)))


def _worth(text: str) -> Iterator[Worth]:
    """The rows of the table of probabilities, wherever it stands on the page."""
    for heads, *rows in tables(text):
        if tuple(heads) == CURVE:
            for span, of, said, true, _ in rows:
                found = figure(true)
                yield Worth(span, float(said), found if found else count(0, int(of)))


def published(folder: Path) -> list[Check]:
    """All checks with a page, the newest code first; of one code, the larger seed."""
    checks = (read(page) for page in folder.glob("seed-*.md"))
    return sorted(checks, key=lambda check: (check.code, check.seed), reverse=True)
