"""The README's table: the newest blind check and the newest independent plant against what is aimed at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bench.blind_pages import Check, Figure, added, figure, tables
from bench.blind_probabilities import calibration_error, error_of, pooled
from bench.blind_summary import MEASURES, POOL, Measure, shown, table, together
from bench.exam_claims import Claims, claims_of

#: Sets of strangers' cases that are added up: the newest ones, which have 50 cases each.
SETS = 8
GOALS = tuple(measure for measure in MEASURES if measure.goal)
KIN = {"reference": "`reference` (first principles)", "thesis": "`thesis` (kin to the design model)"}


@dataclass(frozen=True)
class Column:
    """What stands above a column, what the text below calls it, and its figures by the name of the measure."""

    head: str
    name: str
    figures: Mapping[str, Figure | None]


def newest_plant(strangers: str) -> Column:
    """The first row of the table in docs/strangers.md whose first head is `plant`.

    Raises: `ValueError` when there is none.
    """
    cells = _sets(strangers)[0]
    found = {m.name: shown(m, figure(cells[m.column])) for m in GOALS}
    link = cells["plant"].replace("](", "](docs/")
    return Column(f"{link} independent plant, seed {cells['seed']}: {cells['cases']} cases", "the plant", found)


def newest_sets(strangers: str, claims: Claims) -> Column:
    """The first rows of that table added up, where counts can be, or else from the least to the largest figure.

    Calibration is that of those sets whose claims are kept.
    """
    rows = _sets(strangers)[:SETS]
    sums = {m.name: added(shown(m, figure(cells[m.column])) for cells in rows) for m in GOALS}
    each = {m.name: spread(m, [one for cells in rows if (one := figure(cells[m.column]))]) for m in GOALS}
    found = {name: one if one.of else each[name] for name, one in sums.items()}
    found["calibration error"] = error_of(claims_of(claims, [cells["seed"] for cells in rows]))
    name = f"the newest {len(rows)} sets"
    cases = sum(int(cells["cases"]) for cells in rows if cells["cases"].isdigit())
    head = f"[newest {len(rows)} sets](docs/strangers.md) of independent plants together: {cases} cases"
    return Column(head, name, found)


def _sets(strangers: str) -> list[dict[str, str]]:
    """The rows of the table of plants by the heads. Raises: `ValueError` when there are none."""
    for heads, *rows in tables(strangers):
        if heads[0] == "plant" and rows:
            return [dict(zip(heads, row, strict=True)) for row in rows]
    raise ValueError("docs/strangers.md has no table of plants")


def newest_check(check: Check) -> Column:
    """A check, from the figures over all its valves."""
    found = {m.name: check.figures["all"].get(m.row) for m in GOALS}
    link = f"[{check.seed}](docs/blind/seed-{check.seed}.md)"
    return Column(f"blind check, seed {link}: {check.trials} valves", "the blind check", found)


def newest_checks(checks: Sequence[Check]) -> Column:
    """Several checks added up, where counts can be, or else from the least to the largest: one draw may flatter."""
    sums = {m.name: shown(m, together(m, checks)) for m in GOALS}
    each = {m.name: spread(m, [one for check in checks if (one := check.figures["all"].get(m.row))]) for m in GOALS}
    found = {name: one if one and one.of else each[name] for name, one in sums.items()}
    found["calibration error"] = calibration_error(pooled(checks))
    valves, anchor = sum(check.trials for check in checks), f"the-newest-{len(checks)}-together"
    head = f"[newest {len(checks)} checks](docs/blind.md#{anchor}) together: {valves} valves"
    return Column(head, f"the newest {len(checks)} checks", found)


def spread(measure: Measure, figures: Sequence[Figure]) -> Figure | None:
    """Means or medians of several sets, between which that of all of them lies; the worst one is held to the target."""
    if not figures:
        return None
    ranked = sorted(figures, key=lambda one: one.value)
    worst = ranked[-1 if measure.most else 0]
    return Figure(f"{ranked[0].text} to {ranked[-1].text}", worst.value)


def readme(checks: Sequence[Check], strangers: str, claims: Claims) -> str:
    """The table; below it what is missed, and how the families differ."""
    columns = [newest_check(checks[0]), newest_checks(checks[:POOL])]
    columns += [newest_plant(strangers), newest_sets(strangers, claims)]
    rows = ([m.name, m.goal, *(_cell(m, column.figures[m.name]) for column in columns)] for m in GOALS)
    heads = ["", "target", *(column.head for column in columns)]
    return "\n".join([*table(heads, rows), *map(_missed, columns), "", *_families(checks[0])])


def _cell(measure: Measure, found: Figure | None) -> str:
    if not found:
        return "-"
    text = found.text + (f" ({found.interval})" if found.interval else "")
    return f"**missed**: {text}" if measure.missed(found) else text


def _missed(column: Column) -> str:
    names = [m.name for m in GOALS if (found := column.figures[m.name]) and m.missed(found)]
    return f"- Missed on {column.name}: {', '.join(names) or 'nothing'}."


def _families(check: Check) -> Iterator[str]:
    """First causes by family, because one of them is kin to the design model and flatters."""
    row = next(m.row for m in GOALS if m.column == "first cause")
    found = {name: one for name, figures in check.figures.items() if name in KIN and (one := figures.get(row))}
    if found:
        words = (f"{one.hits} of {one.of} on {KIN[name]}" for name, one in found.items())
        yield f"First causes of the blind check by family: {'; '.join(words)}."
