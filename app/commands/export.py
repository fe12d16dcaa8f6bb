"""Write a run as plain CSV or Parquet."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import click

from app.records import foreign_options, open_run, say_problems
from app.targets import check_apart, check_file
from hal.counted import counted


@click.command()
@click.argument("run")
@click.option("--csv", "csv_file", type=click.Path(path_type=Path), help="CSV file to write; - for standard output.")
@click.option("--parquet", "parquet_file", type=click.Path(path_type=Path), help="Parquet file to write.")
@foreign_options
def command(
    run: str,
    csv_file: Path | None,
    parquet_file: Path | None,
    mapping: str | None,
    units: str | None,
    command_timing: str,
) -> None:
    """Write RUN with one row a sample and the unit in each column's name.

    RUN is a run folder, a name out of `lostmotion runs`, `latest`, or a CSV or Parquet file, which is converted to
    psi, inches and seconds. A missing value is an empty cell.
    """
    from logs.export import write_csv, write_parquet

    if csv_file is None and parquet_file is None:
        raise click.UsageError("say what to write: --csv FILE, --parquet FILE, or both")
    record = open_run(run, mapping, units, command_timing)
    _check({"--csv": None if str(csv_file) == "-" else csv_file, "--parquet": parquet_file}, record.path)
    say_problems(record)
    size = f"{counted(record.rows, 'sample')}, {counted(len(record.columns), 'column')}"
    if csv_file is not None and str(csv_file) == "-":
        write_csv(record, sys.stdout.buffer)
    elif csv_file is not None:
        write_csv(record, csv_file)
        click.echo(f"{csv_file}: {size}")
    if parquet_file is not None:
        write_parquet(record, parquet_file)
        click.echo(f"{parquet_file}: {size}", err=str(csv_file) == "-")


def _check(targets: Mapping[str, Path | None], record: Path) -> None:
    check_apart(targets)
    for option, path in targets.items():
        if path is not None:
            check_file(option, path, (record,))
