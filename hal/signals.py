"""Ctrl-C, SIGTERM and a closed terminal become exceptions, so that every `finally` on the way out runs."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any

_NAMES = tuple(name for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Stopped(KeyboardInterrupt):
    """Somebody outside ended the job. `signal_name` says how: SIGINT is Ctrl-C, SIGHUP a closed terminal."""

    def __init__(self, signal_name: str) -> None:
        super().__init__(f"stopped by {signal_name}")
        self.signal_name = signal_name


@dataclass
class StopRequest:
    """What the loop looks at between two ticks."""

    signal_name: str | None = None

    def check(self) -> None:
        """Raises: `Stopped` when Ctrl-C was pressed since the loop began."""
        if self.signal_name is not None:
            raise Stopped(self.signal_name)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        name = signal.Signals(number).name
        again = self.signal_name is not None
        self.signal_name = name
        # The first Ctrl-C lets the tick finish; a second one, or an order to terminate, does not wait for anything.
        if again or name != "SIGINT":
            raise Stopped(name)


@contextmanager
def stop_signals() -> Iterator[StopRequest]:
    """While open, signals end the job in order: call `check` once a tick. Outside the main thread it does nothing."""
    request = StopRequest()
    with _handlers(request._on_signal):
        yield request


@contextmanager
def terminable() -> Iterator[None]:
    """While open, SIGTERM and a closed terminal raise `Stopped` at once, as Ctrl-C interrupts a job without ticks.

    What somebody has switched off stays off: under nohup a computation outlives its terminal.
    """
    heard = [n for n in _NAMES if n != "SIGINT" and signal.getsignal(getattr(signal, n)) != signal.SIG_IGN]
    with _handlers(_stop, heard):
        yield


def _stop(number: int, _frame: FrameType | None) -> None:
    raise Stopped(signal.Signals(number).name)


@contextmanager
def shielded() -> Iterator[None]:
    """While open, signals wait: for the few moments in which the valve is sent to safety.

    Raises: `Stopped` on leaving when one came meanwhile and nothing else is being raised.
    """
    waiting: list[int] = []
    with _handlers(lambda number, _: waiting.append(number)):
        yield
    if waiting:
        raise Stopped(signal.Signals(waiting[0]).name)


@contextmanager
def _handlers(handler: Callable[[int, FrameType | None], Any], names: Sequence[str] = _NAMES) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may have handlers, and only it gets signals
        return
    before = {name: signal.signal(getattr(signal, name), handler) for name in names}
    try:
        yield
    finally:
        for name, old in before.items():
            # None: a handler that was not set from Python and cannot be put back from here
            signal.signal(getattr(signal, name), old if old is not None else signal.SIG_DFL)
