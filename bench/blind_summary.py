"""The tables of docs/blind.md over all published checks: one by one, and the newest ones added up."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from bench.blind_pages import CURVE, Check, Figure, added, count
from bench.blind_probabilities import pooled, words

POOL = 5  # checks that are added up: the newest ones, which have 80 valves each


@dataclass(frozen=True)
class Measure:
    """A row of the README and a column of the summaries; `row` is where a check's page has it.

    `most`: the target is an upper bound. `none`: a count of what should not be; summaries count the others.
    """

    name: str
    column: str
    row: str
    goal: str = ""
    target: float = float("nan")
    most: bool = False
    none: bool = False

    def missed(self, found: Figure) -> bool:
        """Whether the figure itself misses the target, however wide its interval is."""
        return found.value > self.target if self.most else found.value < self.target


MEASURES = (
    Measure("all right", "all right", "all right: every cause and no other"),
    Measure(
        "a cause named on a healthy valve",
        "healthy, none named",
        "false cause although nothing is wrong",
        "1 % or less",
        0.01,
        most=True,
        none=True,
    ),
    Measure("first named cause true", "first cause", "first named cause is true", "90 % or more", 0.90),
    Measure("its stage right", "stage", "stage of the first named cause", "95 % or more", 0.95),
    Measure("both of two causes named", "both of two", "both of two causes", "75 % or more", 0.75),
    Measure(
        "faults of no known kind called unexplained",
        "outsiders",
        "outsider noticed as unexplained",
        "90 % or more",
        0.90,
    ),
    Measure(
        "names that it cannot tell apart, mean", "set", "mean size of a confusion set", "1.6 or less", 1.6, most=True
    ),
    Measure("calibration error", "calibration error", "expected calibration error", "0.05 or less", 0.05, most=True),
    Measure(
        "gap closed on an unseen closed loop, median",
        "closure",
        "gap closed on an unseen closed-loop record, median",
        "0.95 or more",
        0.95,
    ),
)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Lines of a Markdown table, and an empty one."""
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    yield from (f"| {' | '.join(row)} |" for row in rows)
    yield ""


def shown(measure: Measure, found: Figure | None) -> Figure | None:
    """A figure as the summaries have it."""
    return count(found.of - found.hits, found.of) if found and measure.none else found


def summary(checks: Sequence[Check]) -> str:
    """All published checks, the newest first, and the newest ones together."""
    heads = ["seed", "commit", "trials", *(measure.column for measure in MEASURES)]
    return "\n".join([*table(heads, map(_row, checks)), *_pooled(checks[:POOL])])


def _row(check: Check) -> list[str]:
    found = [shown(measure, check.figures["all"].get(measure.row)) for measure in MEASURES]
    link = f"[{check.seed}](blind/seed-{check.seed}.md)"
    return [link, f"`{check.commit}`", str(check.trials), *(one.text if one else "-" for one in found)]


def _pooled(checks: Sequence[Check]) -> Iterator[str]:
    """Counts of several checks added up, by group of valves, and what such a sum is not."""
    seeds = ", ".join(str(check.seed) for check in reversed(checks))
    groups = sorted({group for check in checks for group in check.figures})
    counted = [measure for measure in MEASURES if together(measure, checks).of]
    yield f"### The newest {len(checks)} together\n"
    yield f"Seeds {seeds}: {sum(check.trials for check in checks)} valves.\n"
    yield "**The code changed between any two of these checks**, also on what the one before had shown. So a rate"
    yield "of this table is an average over several programs, and not what the newest one does; its interval (Wilson)"
    yield "is that of the draw alone. Means and medians cannot be added up from what is published"
    yield "and are left out. Last column: each check by itself, oldest first.\n"
    heads = ["", *(head for group in groups for head in (group, "95 % interval")), "one by one"]
    yield from table(heads, (_pooled_row(measure, checks, groups) for measure in counted))
    yield from _probabilities(checks)


def _probabilities(checks: Sequence[Check]) -> Iterator[str]:
    """What was said against what was true, over those checks whose pages have it."""
    having = [check for check in checks if check.worth]
    pieces = pooled(having)
    if not pieces:
        return
    yield "### What their probabilities were worth\n"
    yield f"Of the checks whose pages say it: {', '.join(str(check.seed) for check in reversed(having))}.\n"
    rows = ([p.span, str(p.true.of), f"{p.said:.4f}", p.true.text, p.true.interval] for p in pieces)
    yield from table(CURVE, rows)
    yield from words(pieces)


def _pooled_row(measure: Measure, checks: Sequence[Check], groups: Sequence[str]) -> list[str]:
    sums = [together(measure, checks, group) for group in groups]
    cells = [cell for one in sums for cell in (one.text, one.interval)]
    single = ", ".join(f"{100.0 * one.value:.0f}" for one in reversed(_of(measure, checks, "all")))
    return [measure.column, *cells, f"{single} %"]


def together(measure: Measure, checks: Sequence[Check], group: str = "all") -> Figure:
    """The counts of several checks added up, as the summaries have them."""
    return added(_of(measure, checks, group))


def _of(measure: Measure, checks: Sequence[Check], group: str) -> list[Figure]:
    """The figures of the checks that have one."""
    found = [shown(measure, check.figures.get(group, {}).get(measure.row)) for check in checks]
    return [one for one in found if one]
