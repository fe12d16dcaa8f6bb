"""A long computation that is told to end keeps what it knows: however it is told, and it says when that is nothing."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import click

from hal.signals import Stopped

_NAMES = tuple(name for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextmanager
def stoppable(out: Path) -> Iterator[None]:
    """While open, SIGTERM and a closed terminal do what Ctrl-C does; one that leaves `out` as it was says so."""
    before = _files_in(out)
    try:
        with _as_interrupts():
            yield
    except KeyboardInterrupt:
        if _files_in(out) == before:
            click.echo("Interrupted before anything was known; nothing was written.", err=True)
        raise


@contextmanager
def _as_interrupts() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may have handlers, and only it gets signals
        return
    # What somebody has switched off stays off: under nohup a computation outlives its terminal.
    numbers = [getattr(signal, name) for name in _NAMES if signal.getsignal(getattr(signal, name)) != signal.SIG_IGN]
    before = {number: signal.signal(number, _stop) for number in numbers}
    try:
        yield
    finally:
        for number, old in before.items():
            # None: a handler that was not set from Python and cannot be put back from here
            signal.signal(number, old if old is not None else signal.SIG_DFL)


def _stop(number: int, _frame: FrameType | None) -> None:
    raise Stopped(signal.Signals(number).name)


def _files_in(folder: Path) -> dict[str, int]:
    """The names in a folder with the times they were written at [ns]; none where there is no folder."""
    if not folder.is_dir():
        return {}
    return {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
