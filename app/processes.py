"""Work for several processes: results in the order of the work, and nobody left behind however it ends."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import TypeVar

from hal.errors import JobFailed

Work = TypeVar("Work")
Answer = TypeVar("Answer")
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def in_order(run: Callable[[Work], Answer], todo: Sequence[Work], processes: int) -> Iterator[Answer]:
    """`run` of each, in the order of `todo`; the number of processes changes nothing. Left early, it ends them all.

    Raises: what `run` raises; `JobFailed` when a process is killed.
    """
    if processes <= 1:
        yield from map(run, todo)
        return
    with workers(processes) as pool:
        yield from pool.map(run, todo)


@contextmanager
def workers(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Fresh processes with one thread each, ended when the context is left. Raises: `JobFailed` when one is killed."""
    for name in _THREADS:
        os.environ.setdefault(name, "1")  # read by a worker when it imports numpy
    pool = ProcessPoolExecutor(processes, multiprocessing.get_context("spawn"), initializer=_deaf)
    try:
        yield pool
    except BrokenProcessPool as error:
        raise JobFailed("a worker was killed, for want of memory perhaps; give the command again") from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        # A run that records takes a signal as the wish to stop *it*; its valve is virtual, so it can just end.
        for child in multiprocessing.active_children():
            child.kill()


def _deaf() -> None:
    """A worker does not hear Ctrl-C: its master does, and ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
