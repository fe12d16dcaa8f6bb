"""List the recorded runs."""

from __future__ import annotations

import json
from pathlib import Path

import click

from hal.errors import BadInput
from logs.find import Summary, run_folders, summarize
from logs.writer import DEFAULT_ROOT

COLOURS = {"success": "green", "abort": "yellow", "fail": "red", "crash": "red", "running": "cyan"}


@click.command()
@click.argument("folder", type=click.Path(path_type=Path), default=DEFAULT_ROOT)
@click.option("--last", type=click.IntRange(min=1), help="Only the newest so many.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON for scripts.")
def command(folder: Path, last: int | None, as_json: bool) -> None:
    """List the recorded runs under FOLDER (default: logs/runs), oldest first, with how each ended and why."""
    if not folder.is_dir() and (folder.exists() or folder != DEFAULT_ROOT):  # the default may not be there yet
        what = "is a file" if folder.exists() else "does not exist"
        raise BadInput(f"{folder} {what}; name a folder with recorded runs in it (default: {DEFAULT_ROOT})")
    folders = run_folders(folder)
    runs = [summarize(each) for each in (folders[-last:] if last else folders)]
    if as_json:
        click.echo(json.dumps([_plain(run) for run in runs], indent=1, ensure_ascii=False))
    elif not runs:
        click.echo(f"No runs under {folder}. `lostmotion sweep staircase` records one on the virtual valve.")
    else:
        _print(runs)


def _print(runs: list[Summary]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, header_style="bold", pad_edge=False)
    for title in ("Run", "Kind", "Started (UTC)", "Ended", "Samples", "Length", "Controller", "Why, and notes"):
        table.add_column(title, overflow="fold", justify="right" if title in ("Samples", "Length") else "left")
    for run in runs:
        words = "; ".join(each for each in (run.reason if run.status != "success" else "", run.note) if each)
        table.add_row(
            run.path.name,
            run.kind,
            run.utc[:19].replace("T", " "),
            Text(run.status, style=COLOURS.get(run.status, "")),
            "?" if run.rows is None else f"{run.rows}",
            "?" if run.seconds is None else f"{run.seconds:.0f} s",
            run.controller,
            Text(words),
        )
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 200  # nobody's line breaks belong in a pipe
    console.print(table)


def _plain(run: Summary) -> dict[str, object]:
    return {
        "path": str(run.path),
        "name": run.path.name,
        "kind": run.kind,
        "utc": run.utc,
        "status": run.status,
        "reason": run.reason,
        "rows": run.rows,
        "seconds": run.seconds,
        "controller": run.controller,
        "note": run.note,
        "size_bytes": run.size_bytes,
    }
