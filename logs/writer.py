"""Writes a run while it happens. The control tick hands over a row and goes on; a thread does the rest.

A killed process loses what the thread had not yet been woken for: at most 50 rows or 0.5 s. A power cut loses at most
the last few seconds, and the whole batches before it stay readable. Nothing is ever dropped: should the disk fail, the
next `append` says so, because a run whose record is lost must not go on as if it were kept.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from hal.clock import utc_now
from hal.errors import BadInput, JobFailed
from logs.layout import START, STOP, write_document
from logs.run import StopStatus
from logs.sink import RecordSink
from logs.start import provenance

DEFAULT_ROOT = Path("logs") / "runs"
BATCH_ROWS = 50
FLUSH_PERIOD_S = 0.4

Row = tuple[float, ...]
Entry = dict[str, object]


def check_empty(folder: Path) -> None:
    """Raises: `BadInput` when a record cannot go into the folder, because there is something in it."""
    try:
        taken = folder.is_dir() and any(folder.iterdir())
    except OSError:
        return  # making the record will say what is wrong with it
    if taken:
        raise BadInput(f"{folder}: the folder is not empty, and a record is never overwritten; name a new folder")


class RunWriter:
    """One open record. `append`, `event` and `note` may be called from any thread and do no input or output."""

    def __init__(self, folder: Path, start: Mapping[str, object], sink: RecordSink) -> None:
        """Use `create`; a writer wraps a folder whose start document is already on disk."""
        self.folder = folder
        self.start = start
        self._sink = sink
        self._names = tuple(sink.names)
        self._known = frozenset(self._names)
        self._queue: deque[Row | Entry | threading.Event] = deque()
        self._handed = 0
        self._first_time_s: float | None = None
        self._last_time_s: float | None = None
        self._wake = threading.Event()
        self._closing = False
        self._closed = False
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._work, name="run-record", daemon=True)
        self._thread.start()

    @classmethod
    def create(cls, folder: Path | None, start: Mapping[str, object], columns: Mapping[str, str]) -> RunWriter:
        """Makes the folder and its start document, on disk before this returns.

        `columns` gives the unit of each column, "" where it has none; every column is float64 and NaN where a row
        leaves it out. `start` is merged over `provenance()`; its "kind" names a default folder under ./logs/runs.
        Raises: `BadInput` when the folder holds something already or cannot be made.
        """
        document: dict[str, object] = {**provenance(), **start, "columns": dict(columns)}
        path = folder if folder is not None else _default_folder(str(document.get("kind", "run")))
        check_empty(path)
        try:
            path.mkdir(parents=True, exist_ok=True)
            write_document(path / START, document)
            sink = RecordSink(path, document, columns)
        except OSError as error:
            why = error.strerror or str(error)
            raise BadInput(
                f"{path}: no run can be recorded there ({why}); name a folder that can be written"
            ) from error
        return cls(path, document, sink)

    @property
    def rows(self) -> int:
        """Rows handed over so far."""
        return self._handed

    def append(self, row: Mapping[str, float]) -> None:
        """Takes one row; costs microseconds and never waits.

        Raises: `JobFailed` when the disk has refused earlier rows; `ValueError` for a column that was not declared.
        """
        if not self._known.issuperset(row):
            raise ValueError(f"columns {sorted(set(row) - self._known)} were not declared when the record was created")
        if self._failure is not None:
            raise self._lost()
        nan = float("nan")
        self._queue.append(tuple(row.get(name, nan) for name in self._names))
        self._handed += 1
        self._last_time_s = row.get("time_s", self._last_time_s)
        if self._handed == 1:
            self._first_time_s = self._last_time_s
        if len(self._queue) >= BATCH_ROWS:
            self._wake.set()

    def event(self, time_s: float | None, level: str, text: str) -> None:
        """Records what happened at bench time `time_s`; `level` is "info", "warning" or "error"."""
        self._enter("event", time_s, level, text)

    def note(self, time_s: float | None, text: str) -> None:
        """Records what the operator has to say."""
        self._enter("note", time_s, "info", text)

    def state(self, time_s: float | None, text: str) -> None:
        """Records that the bench is in state `text` from now on: the state timeline of the view."""
        self._enter("state", time_s, "info", text)

    def flush(self) -> None:
        """Returns when everything handed over is on the disk, power cut included. For step ends; it waits.

        Raises: `JobFailed` when the disk refused it.
        """
        done = threading.Event()
        self._queue.append(done)
        self._wake.set()
        done.wait()
        if self._failure is not None:
            raise self._lost()

    def close(self, status: StopStatus, reason: str) -> None:
        """Writes what is left and then the stop document. The first close counts, later ones do nothing.

        Raises: `JobFailed` when rows could not be written.
        """
        if self._closed:
            return
        self._closed = True
        self._closing = True
        self._wake.set()
        self._thread.join()
        if self._failure is None:
            try:
                self._sink.close()
                write_document(self.folder / STOP, self._stop(status, reason))
            except OSError as error:
                self._failure = error
        if self._failure is not None:
            raise self._lost()

    def _stop(self, status: StopStatus, reason: str) -> dict[str, object]:
        return {
            "uuid": self.start.get("uuid"),
            "status": status,
            "reason": reason,
            "utc": utc_now().isoformat(timespec="milliseconds"),
            "rows": self._handed,
            "first_time_s": self._first_time_s,
            "last_time_s": self._last_time_s,
        }

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Closes what nobody closed: success without an exception, abort on Ctrl-C, fail with its sentence else."""
        if error is None:
            self.close("success", "finished")
        elif isinstance(error, KeyboardInterrupt):
            self.close("abort", "interrupted by the operator")
        else:
            self.close("fail", f"{type(error).__name__}: {error}")

    def _enter(self, kind: str, time_s: float | None, level: str, text: str) -> None:
        utc = utc_now().isoformat(timespec="milliseconds")
        self._queue.append({"time_s": time_s, "kind": kind, "level": level, "text": text, "utc": utc})
        self._wake.set()

    def _lost(self) -> JobFailed:
        error = self._failure
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return JobFailed(f"{self.folder}: the record can no longer be written ({why}); free the disk and run again")

    def _work(self) -> None:
        while True:
            closing = self._closing  # read before draining: what was handed over before it is written below
            try:
                self._drain()
            except Exception as error:  # whatever it is, a waiter must not hang and the next `append` must say it
                self._failure = error
            if closing:
                return
            self._wake.wait(FLUSH_PERIOD_S)
            self._wake.clear()

    def _drain(self) -> None:
        """Writes everything in the queue, in order, as one batch of rows between two waiters."""
        waiters: list[threading.Event] = []
        rows: list[Row] = []
        try:
            while self._queue:
                item = self._queue.popleft()
                if isinstance(item, tuple):
                    rows.append(item)
                elif isinstance(item, threading.Event):
                    waiters.append(item)
                elif self._failure is None:
                    self._sink.write_event(item)
            if rows and self._failure is None:
                self._sink.write_rows(rows)
            if self._failure is None:
                self._sink.sync(now=bool(waiters))
        finally:
            for waiter in waiters:
                waiter.set()


def _default_folder(kind: str) -> Path:
    """A folder that is not there yet: logs/runs/<UTC stamp>-<kind>, numbered when two runs start in one second."""
    stem = f"{utc_now():%Y%m%d-%H%M%S}-{kind}"
    path, number = DEFAULT_ROOT / stem, 2
    while path.exists():
        path, number = DEFAULT_ROOT / f"{stem}-{number}", number + 1
    return path
