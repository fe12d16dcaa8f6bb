"""How well a closed loop has held its targets, as the operator or a script wants to read it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from control.tracking import TargetResult


def report(results: Sequence[TargetResult], folder: Path, travel_in: float, where: str, as_json: bool) -> None:
    """Prints one line a target, or JSON."""
    from dataclasses import asdict

    if as_json:
        worst = max((abs(r.final_error_in) for r in results), default=float("nan"))
        document = {
            "run": str(folder),
            "targets": [asdict(result) for result in results],
            "worst_final_error_percent": 100.0 * worst / travel_in,
        }
        click.echo(json.dumps(document))
        return
    from app.tables import console, new_table

    headings = ("target", "position", "error", "error", "swing", "settled")
    units = ("in", "in", "in", "% of travel", "% of travel", "s")
    table = new_table(
        "final error = mean over the last quarter of each hold",
        [f"{heading}\n[{unit}]" for heading, unit in zip(headings, units, strict=True)],
    )
    for r in results:
        table.add_row(
            f"{r.target_in:.4f}",
            f"{r.final_in:.4f}",
            f"{r.final_error_in:+.4f}",
            f"{100 * r.final_error_in / travel_in:+.2f}",
            f"{100 * r.swing_in / travel_in:.2f}",
            "never" if r.settled_s is None else f"{r.settled_s:.1f}",
        )
    console().print(table)
    click.echo(f"{where}; record: {folder}")
