"""The files of a record that is being written: rows as Arrow batches, events as lines; used by one thread only."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from io import BufferedWriter
from pathlib import Path

from hal.clock import RealClock
from logs.layout import EVENTS, SAMPLES, to_plain

SYNC_PERIOD_S = 3.0


class RecordSink:
    """Appends to `samples.arrows` and `events.jsonl`. Raises: `OSError` from every method, as the disk gives it."""

    def __init__(self, folder: Path, start: Mapping[str, object], columns: Mapping[str, str]) -> None:
        import numpy as np
        import pyarrow as pa

        pa.array(np.zeros(0))  # the first one imports a tenth of a second's worth of modules: not during the run
        self.names = tuple(columns)
        fields = [pa.field(name, pa.float64(), metadata={"unit": unit}) for name, unit in columns.items()]
        head = json.dumps(to_plain(start), ensure_ascii=False)
        self._schema = pa.schema(fields, metadata={"start": head})
        self._clock = RealClock()
        self._samples: BufferedWriter = (folder / SAMPLES).open("xb")
        self._events: BufferedWriter = (folder / EVENTS).open("ab")
        _lock(self._samples)
        self._stream = pa.ipc.new_stream(self._samples, self._schema)
        self._samples.flush()
        self._synced_s = self._clock.now_s()
        self._dirty = True

    def write_rows(self, rows: Sequence[tuple[float, ...]]) -> None:
        """One batch, handed to the operating system whole: a killed process does not lose it."""
        import numpy as np
        import pyarrow as pa

        block = np.array(rows, dtype=np.float64).T
        batch = pa.record_batch([pa.array(np.ascontiguousarray(column)) for column in block], schema=self._schema)
        self._stream.write_batch(batch)
        self._samples.flush()
        self._dirty = True

    def write_event(self, entry: Mapping[str, object]) -> None:
        self._events.write(event_line(entry))
        self._events.flush()
        self._dirty = True

    def sync(self, now: bool) -> None:
        """Makes it survive a power cut: every few seconds, or `now`."""
        if self._dirty and (now or self._clock.now_s() - self._synced_s >= SYNC_PERIOD_S):
            _data_sync(self._samples.fileno())
            _data_sync(self._events.fileno())
            self._synced_s = self._clock.now_s()
            self._dirty = False

    def close(self) -> None:
        """Ends the stream properly and lets go of the files."""
        self._stream.close()
        self._samples.flush()
        self._dirty = True
        self.sync(now=True)
        self._samples.close()
        self._events.close()


def event_line(entry: Mapping[str, object]) -> bytes:
    """One line of the event file. Written with a single call, so that two writers cannot mix their lines."""
    return (json.dumps(to_plain(entry), ensure_ascii=False) + "\n").encode()


def _data_sync(handle: int) -> None:
    getattr(os, "fdatasync", os.fsync)(handle)


def _lock(file: BufferedWriter) -> None:
    """Tells readers that somebody is still writing; the lock dies with the process. Without flock nobody is told."""
    with suppress(ImportError, OSError):
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
