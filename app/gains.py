"""A parameter of a loop swept: what is swept, the table as CSV, and the picture of swing and period against it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hal.errors import BadInput

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from app.hunting import Case
    from control.analysis.loop import LinearLoop

NAMES = {"kp": "kp", "ki": "ki", "dead_time": "dead_time_s", "late": "late_s"}
UNITS = {"kp": "psi/in", "ki": "psi/(in s)", "dead_time": "s", "late": "s"}
COLUMNS = ("describing_function", "harmonic_balance", "measured")


@dataclass(frozen=True, slots=True)
class Sweep:
    """One parameter, by its name on the command line, and its values."""

    name: str
    values: tuple[float, ...]

    @property
    def label(self) -> str:
        return f"{self.name} [{UNITS[self.name]}]"

    def loops(self, base: LinearLoop) -> list[LinearLoop]:
        """The loop with every value."""
        return [replace(base, **{NAMES[self.name]: value}) for value in self.values]  # type: ignore[arg-type]


def parse_sweep(text: str) -> Sweep:
    """`kp=1:6:11`: eleven values from 1 to 6.

    Raises: `BadInput` for another form, an unknown name, negative numbers, or more than 200 values.
    """
    name, _, span = text.partition("=")
    try:
        first, last, count = span.split(":")
        low, high, n = float(first), float(last), int(count)
    except ValueError as error:
        raise BadInput(f"--sweep {text!r} is not of the form NAME=FROM:TO:COUNT, for example kp=1:6:11") from error
    if name not in NAMES:
        raise BadInput(f"--sweep has no {name!r}; choose from {', '.join(NAMES)}")
    if not (math.isfinite(low + high) and 0.0 <= low < high and 2 <= n <= 200):
        raise BadInput(f"--sweep {text!r} needs 0 <= FROM < TO and 2 to 200 values")
    return Sweep(name, tuple(float(f"{value:.12g}") for value in np.linspace(low, high, n)))


def swings(case: Case, travel_in: float) -> Iterator[tuple[float, float]]:
    """Peak to peak of the stem [% of travel] and period [s], by describing function, balance (the largest) and
    measurement; NaN where there is none."""
    for cycle in (case.predicted, case.balanced[0] if case.balanced else None, case.measured):
        found = (200.0 * cycle.stem_in / travel_in, cycle.period_s) if cycle else (math.nan, math.nan)
        yield found


def write_csv(cases: Sequence[Case], travel_in: float, path: Path) -> None:
    """One line per loop; empty where there is no limit cycle."""
    head = ["law", "kp_psi_per_in", "ki_psi_per_in_s", "dead_time_s", "late_s"]
    head += [f"{how}_{what}" for how in COLUMNS for what in ("swing_percent", "period_s")]
    lines = [",".join(head)]
    for case in cases:
        loop = case.loop
        cells = [loop.law, *(f"{v:g}" for v in (loop.kp, loop.ki, loop.dead_time_s, loop.late_s))]
        for pair in swings(case, travel_in):
            cells += ["" if math.isnan(value) else f"{value:.4g}" for value in pair]
        lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def draw_gains(cases: Sequence[Case], travel_in: float, sweep: Sweep, path: Path) -> None:
    """Swing and period against the swept parameter, into a file."""
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=(7.2, 3.4), dpi=100, layout="constrained")
    left, right = canvas.subplots(1, 2, sharex=True)
    curves(left, right, cases, travel_in, sweep.values)
    for axes in (left, right):
        axes.set_xlabel(sweep.label)
    left.legend(frameon=False, fontsize=7)
    canvas.savefig(path)


def curves(
    left: Axes,
    right: Axes,
    cases: Sequence[Case],
    travel_in: float,
    values: Sequence[float],
    colour: str = "#1f5fa8",
    note: str = "",
) -> None:
    """Swing on the left, period on the right: describing function as a line, balance as rings, measured as crosses."""
    found = np.array([list(swings(case, travel_in)) for case in cases])
    styles = ({"ls": "-", "lw": 1.2}, {"ls": "", "marker": "o", "mfc": "none"}, {"ls": "", "marker": "x", "ms": 4})
    for column, (name, style) in enumerate(zip(COLUMNS, styles, strict=True)):
        label = f"{name.replace('_', ' ')}{note}"
        left.plot(values, found[:, column, 0], color=colour, label=label, **style)  # type: ignore[arg-type]
        right.plot(values, found[:, column, 1], color=colour, label=label, **style)  # type: ignore[arg-type]
    left.set_ylabel("swing of the stem [% of travel]")
    right.set_ylabel("period [s]")
