"""A long computation that is told to end keeps what it knows: however it is told, and it says when that is nothing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from hal.signals import terminable


@contextmanager
def stoppable(out: Path) -> Iterator[None]:
    """While open, SIGTERM and a closed terminal do what Ctrl-C does; one that leaves `out` as it was says so."""
    before = _files_in(out)
    try:
        with terminable():
            yield
    except KeyboardInterrupt:
        if _files_in(out) == before:
            click.echo("Interrupted before anything was known; nothing was written.", err=True)
        raise


def _files_in(folder: Path) -> dict[str, int]:
    """The names in a folder with the times they were written at [ns]; none where there is no folder."""
    if not folder.is_dir():
        return {}
    return {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
