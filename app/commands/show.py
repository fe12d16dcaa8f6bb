"""Show one run: what it was, how it ended, figures, data quality, a sketch."""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import isnan
from typing import TYPE_CHECKING

import click

from app.records import foreign_options, open_run
from hal.counted import counted

if TYPE_CHECKING:
    from rich.console import Console

    from logs.run import Run

SKETCHED = ("command", "pressure", "position", "target")
HEAD = (
    *("kind", "utc", "experiment", "controller", "profile", "seed", "note", "calibration_id"),
    *("version", "git", "uuid"),
)


@click.command()
@click.argument("run")
@click.option("--json", "as_json", is_flag=True, help="Print JSON for scripts.")
@click.option("--full", is_flag=True, help="The whole start document too.")
@foreign_options
def command(run: str, as_json: bool, full: bool, mapping: str | None, units: str | None, command_timing: str) -> None:
    """Show RUN: a run folder, a name out of `lostmotion runs`, `latest`, or a CSV or Parquet file."""
    record = open_run(run, mapping, units, command_timing)
    if as_json:
        click.echo(json.dumps(_as_json(record), indent=1, ensure_ascii=False))
        return
    from rich.console import Console

    console = Console(highlight=False, soft_wrap=True)
    _print_head(console, record, full)
    _print_figures(console, record)
    _print_words(console, record)
    _print_sketch(console, record)


def _quality(run: Run) -> list[tuple[str, str, int, int | None]]:
    """The data-quality notes, or the sentence why the samples are no use."""
    from hal.errors import BadInput
    from logs.load import recording_of_run

    try:
        notes = recording_of_run(run).notes
    except BadInput as error:
        return [(str(error), "not usable for analysis", 0, None)]
    return [(note.what, note.handled, note.rows, note.first_row) for note in notes]


def _print_head(console: Console, run: Run, full: bool) -> None:
    from rich.table import Table
    from rich.text import Text

    colour = {"success": "green", "running": "cyan", "abort": "yellow"}.get(run.status, "red")
    console.print(Text.assemble((run.name, "bold"), "  ", (run.status, colour), f"  {run.reason}"))
    table = Table(box=None, show_header=False, pad_edge=False)
    keys = list(run.start) if full else [key for key in HEAD if key in run.start]
    for key in keys:
        words = _words(run.start[key], full)
        if words:
            table.add_row(key.replace("_", " "), Text(words))
    console.print(table)
    for problem in run.problems:
        console.print(Text(f"! {problem}", style="yellow"))


def _words(value: object, full: bool) -> str:
    if isinstance(value, Mapping):
        name = value.get("name") or value.get("kind")
        if name and not full:
            return str(name)
        return json.dumps(value, ensure_ascii=False)
    return "" if value is None else str(value)


def _print_figures(console: Console, run: Run) -> None:
    from rich.table import Table

    from logs.statistics import column_statistics, timing

    table = Table(box=None, header_style="bold", pad_edge=False)
    for title in ("Column", "unit", "lowest", "mean", "highest", "std dev", "missing"):
        table.add_column(title, justify="left" if title in ("Column", "unit") else "right")
    for each in column_statistics(run):
        figures = ["-" if isnan(value) else f"{value:.5g}" for value in (each.low, each.mean, each.high, each.spread)]
        table.add_row(each.name, each.unit, *figures, str(each.missing or ""))
    console.print()
    console.print(f"{counted(run.rows, 'sample')}, {run.duration_s:.6g} s, one every {timing(run).period_s:.4g} s")
    for name, delay in (("lateness", timing(run).lateness_s), ("latency", timing(run).latency_s)):
        if delay is not None:
            median, p99, worst = (1e3 * each for each in delay)
            console.print(f"{name}: median {median:.3g} ms, 99 % below {p99:.3g} ms, worst {worst:.3g} ms")
    console.print()
    console.print(table)


def _print_words(console: Console, run: Run) -> None:
    from rich.text import Text

    console.print()
    console.print("Data quality", style="bold")
    notes = _quality(run)
    for what, handled, rows, first in notes:
        console.print(Text(f"- {what}{_where(rows, first)}: {handled}"))
    if not notes:
        console.print("- nothing to remark")
    said = [event for event in run.events if event.kind != "state"]
    if said:
        console.print()
        console.print("Events and notes", style="bold")
    for event in said:
        at = "after the end" if event.time_s is None else f"{event.time_s:.2f} s"
        console.print(Text(f"- {at}: {'note: ' if event.kind == 'note' else ''}{event.text}"))


def _where(rows: int, first: int | None) -> str:
    if first:
        return f" (row {first})" if rows == 1 else f" ({rows} rows, the first is row {first})"
    return f" ({counted(rows, 'row')})" if rows else ""


def _print_sketch(console: Console, run: Run) -> None:
    from rich.text import Text

    from control.preview import with_scale

    if run.rows < 2 or not _can_draw(console):
        return
    width = max(30, min(console.width - 16, 100))
    for name in run.columns:
        if name.partition("_")[0] in SKETCHED and not name.endswith("_quality"):
            console.print()
            console.print(Text(name, style="bold"))
            for line in with_scale(run.columns[name], run.units.get(name, ""), columns=width, rows=4):
                console.print(Text(line))


def _can_draw(console: Console) -> bool:
    return (console.encoding or "").lower().replace("-", "").startswith("utf8")


def _as_json(run: Run) -> dict[str, object]:
    from dataclasses import asdict

    from logs.layout import to_plain
    from logs.statistics import column_statistics, timing

    document = {
        "path": str(run.path),
        "status": run.status,
        "reason": run.reason,
        "problems": list(run.problems),
        "start": run.start,
        "rows": run.rows,
        "seconds": run.duration_s,
        "timing": asdict(timing(run)),
        "columns": [asdict(each) for each in column_statistics(run)],
        "events": [asdict(event) for event in run.events],
        "data_quality": [
            {"what": what, "handled": handled, "rows": rows, "first_row": first}
            for what, handled, rows, first in _quality(run)
        ],
    }
    plain = to_plain(document)
    assert isinstance(plain, dict)
    return plain
