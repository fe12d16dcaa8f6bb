"""A run shown in rerun while it happens. The control tick hands over a row; nothing here can delay it or stop it.

The view is served from this process on the loopback address, so that viewers may come, die and come back. When the
view cannot keep up it drops rows and counts them; when it fails it turns itself off and says why in `trouble`.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from hal.clock import utc_now
from logs.arrange import arrange
from logs.feed import about, send_events, send_samples, send_trail
from logs.ports import free_port, listens
from logs.run import Event
from logs.scene import Scene

if TYPE_CHECKING:
    import rerun as rr

CAPACITY_ROWS = 20_000
PERIOD_S = 0.1
TRAIL_S = 30.0
SERVER_MEMORY = "256MiB"

Row = tuple[float, ...]


class RunView:
    """A live view of one run. No method raises and none waits, except `close`, which waits 5 s at most.

    `uri` is where a viewer connects, "" when there is none; `trouble` says why the view is off, "" when it is on.
    """

    def __init__(self, columns: Mapping[str, str], start: Mapping[str, object]) -> None:
        """Use `open`."""
        self.uri = ""
        self.trouble = ""
        self.dropped = 0
        self._units = dict(columns)
        self._names = tuple(columns)
        self._scene = Scene.of(columns, start)
        self._queue: deque[Row | Event] = deque()
        self._origin_s: float | None = None
        self._end_s = 0.0
        self._last_point: np.ndarray[tuple[int, int], np.dtype[np.float64]] | None = None
        self._stop = threading.Event()
        self._stream: rr.RecordingStream | None = None
        self._thread: threading.Thread | None = None

    @classmethod
    def open(
        cls,
        start: Mapping[str, object],
        columns: Mapping[str, str],
        *,
        serve: bool = True,
        file: Path | None = None,
        design: Mapping[str, object] | None = None,
    ) -> RunView:
        """Starts the view; takes the second that importing rerun takes, so call it before the run.

        `columns` and `start` are those of the `RunWriter`. With `serve` viewers can connect to `uri`; with `file`
        the view is written there too. `design` draws its curves where `start` names no design.
        """
        view = cls(columns, {**start, "design": start.get("design") or design})
        try:
            view._start(start, serve, file)
        except Exception as error:  # the view is a convenience: whatever it is, the run goes on
            view._turn_off(error)
        return view

    @property
    def on(self) -> bool:
        return not self.trouble and self._thread is not None

    def append(self, row: Mapping[str, float]) -> None:
        """Takes one row; costs microseconds."""
        if self._room():
            nan = float("nan")
            self._queue.append(tuple(row.get(name, nan) for name in self._names))

    def event(self, time_s: float | None, level: str, text: str) -> None:
        self._say(Event(time_s, level, text))

    def note(self, time_s: float | None, text: str) -> None:
        self._say(Event(time_s, "info", text, kind="note"))

    def state(self, time_s: float | None, text: str) -> None:
        """The bench is in state `text` from `time_s` on."""
        self._say(Event(time_s, "info", text, kind="state"))

    def close(self) -> None:
        """Sends what is left, and ends the service. Safe to call twice."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join(5.0)
        stream, self._stream = self._stream, None
        if stream is None:
            return
        try:
            stream.flush(timeout_sec=5)
            stream.disconnect()
        except Exception as error:
            self._turn_off(error)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _start(self, start: Mapping[str, object], serve: bool, file: Path | None) -> None:
        os.environ.setdefault("CI", "true")  # viewers started from here neither phone home nor greet
        import rerun as rr

        tick = rr.ChunkBatcherConfig(flush_tick=PERIOD_S)
        name = str(start.get("uuid", "")) or None
        stream = rr.RecordingStream("lostmotion", recording_id=name, batcher_config=tick)
        sinks: list[rr.GrpcServerSink | rr.FileSink] = []
        port = free_port() if serve else 0
        if serve:
            sinks.append(rr.GrpcServerSink(bind_ip="127.0.0.1", port=port, server_memory_limit=SERVER_MEMORY))
        if file is not None:
            file.touch()  # rerun itself would only log that it cannot write
            sinks.append(rr.FileSink(file))
        stream.set_sinks(*sinks)
        if serve:
            if not listens(port, patience_s=3.0):
                raise OSError(f"nothing answers on the view's port {port}")
            self.uri = f"rerun+http://127.0.0.1:{port}/proxy"
        stream.send_recording_name(f"{start.get('kind', 'run')} {str(start.get('utc', utc_now().isoformat()))[:19]}")
        stream.send_blueprint(arrange(self._scene, duration_s=None, trail_s=TRAIL_S))
        self._scene.draw_static(stream)
        page = rr.TextDocument(about(start), media_type=rr.MediaType.MARKDOWN)
        stream.log("/about", page, static=True)
        self._stream = stream
        self._thread = threading.Thread(target=self._work, name="run-view", daemon=True)
        self._thread.start()

    def _say(self, event: Event) -> None:
        if self._room():
            self._queue.append(event)

    def _room(self) -> bool:
        if not self.on:
            return False
        if len(self._queue) < CAPACITY_ROWS:
            return True
        self.dropped += 1
        return False

    def _work(self) -> None:
        try:
            while not self._stop.wait(PERIOD_S):
                self._drain()
            self._drain()
            if self.dropped and self._stream is not None:
                lost = Event(None, "warning", f"this view lost {self.dropped} rows; the record has all of them")
                send_events(self._stream, [lost], 0.0, self._end_s)
        except Exception as error:
            self._turn_off(error)

    def _drain(self) -> None:
        items = [self._queue.popleft() for _ in range(len(self._queue))]
        rows = [item for item in items if isinstance(item, tuple)]
        events = [item for item in items if isinstance(item, Event)]
        if self._stream is None or not items:
            return
        if self._origin_s is None:
            times = [row[self._names.index("time_s")] for row in rows]
            times += [event.time_s for event in events if event.time_s is not None]
            self._origin_s = min(times, default=0.0)
        if rows:
            self._send_rows(self._stream, np.array(rows, dtype=np.float64))
        send_events(self._stream, events, self._origin_s, self._end_s)

    def _send_rows(self, stream: rr.RecordingStream, block: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
        columns = {name: block[:, number] for number, name in enumerate(self._names)}
        time_s = columns["time_s"] - (self._origin_s or 0.0)
        send_samples(stream, self._scene, time_s, columns)
        self._end_s = float(time_s[-1])
        if self._scene.plane is None:
            return
        path = np.column_stack((columns[self._scene.plane_x], columns[self._scene.position]))
        good = np.isfinite(path).all(axis=1)
        path, time_s = path[good], time_s[good]
        if self._last_point is not None and len(path):
            path = np.concatenate((self._last_point, path))
            time_s = np.concatenate((time_s[:1], time_s))
        if len(path):
            self._last_point = path[-1:]
            send_trail(stream, self._scene, time_s, path, size=len(path))

    def _turn_off(self, error: Exception) -> None:
        self.trouble = f"the view is off ({type(error).__name__}: {error}); the run and its record go on"
        self._queue.clear()
