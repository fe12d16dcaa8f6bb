"""A run as plain CSV or Parquet, for tools that know nothing of us."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from hal.errors import BadInput
from logs.layout import to_plain
from logs.run import Run

FIRST = ("time_s", "command", "pressure", "position", "target")


def write_csv(run: Run, target: Path | BinaryIO) -> None:
    """A header with the unit in each name, then one line a sample; a missing value is an empty cell.

    Numbers are written so that reading them back gives the same float64. Raises: `BadInput` when it cannot be written.
    """
    from pyarrow import csv

    table = as_table(run)
    head = (",".join(table.column_names) + "\n").encode()

    def write(file: BinaryIO) -> None:
        file.write(head)  # pyarrow would put the names into quotes, which some readers keep
        csv.write_csv(table, file, csv.WriteOptions(include_header=False, quoting_style="none"))

    if isinstance(target, Path):
        _write(target, write)
    else:
        write(target)


def write_parquet(run: Run, target: Path) -> None:
    """One file with the samples, the unit of each column and the start and stop documents in its metadata."""
    from pyarrow import parquet

    table = as_table(run)
    _write(target, lambda file: parquet.write_table(table, file, compression="zstd"))


def as_table(run: Run) -> Any:
    """A pyarrow table: the fixed columns first, NaN as null.

    Raises: `BadInput` for a run without columns.
    """
    import pyarrow as pa

    if not run.columns:
        raise BadInput(f"{run.path}: the run holds no columns ({run.reason}); there is nothing to export")
    names = sorted(run.columns, key=_rank)
    arrays = [pa.array(run.columns[name], mask=np.isnan(run.columns[name])) for name in names]
    fields = [pa.field(name, pa.float64(), metadata={"unit": run.units.get(name, "")}) for name in names]
    stop = {"status": run.status, "reason": run.reason}
    words = {"start": json.dumps(to_plain(run.start)), "stop": json.dumps(stop)}
    return pa.table(arrays, schema=pa.schema(fields, metadata=words))


def _rank(name: str) -> int:
    """The fixed columns in their fixed order, then the rest as recorded."""
    for number, stem in enumerate(FIRST):
        if name == stem or name.startswith(f"{stem}_"):
            return number
    return len(FIRST)


def _write(target: Path, write: Callable[[BinaryIO], None]) -> None:
    """Writes beside the target and renames, so that a full disk leaves no half file under its name."""
    special = target.exists() and not target.is_file()  # a pipe or a device: written to, not replaced
    partial = target if special else target.with_name(target.name + ".partial")
    try:
        with partial.open("wb") as file:
            write(file)
        if not special:
            partial.replace(target)
    except OSError as error:
        if not special:
            partial.unlink(missing_ok=True)
        raise BadInput(f"{target}: cannot be written ({error.strerror or error}); name another file") from error
