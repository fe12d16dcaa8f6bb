"""The rerun stream of a run while it happens: takes rows and events in blocks, serves viewers, writes a file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hal.clock import utc_now
from logs.arrange import arrange
from logs.feed import about, send_events, send_samples, send_trail
from logs.ports import free_port, listens
from logs.run import Event
from logs.scene import Scene
from logs.view_wire import Row

if TYPE_CHECKING:
    import rerun as rr

PERIOD_S = 0.1
TRAIL_S = 30.0
SERVER_MEMORY = "256MiB"

FloatBlock = np.ndarray[tuple[int, int], np.dtype[np.float64]]


class LiveStream:
    """One run in rerun. `uri` is where a viewer connects on the loopback address, "" without `serve`.

    `columns` and `start` are those of the `RunWriter`; with `file` the view is written there too.
    Raises: whatever rerun and the system raise; whoever calls turns the view off then.
    """

    def __init__(self, start: Mapping[str, object], columns: Mapping[str, str], serve: bool, file: Path | None) -> None:
        os.environ.setdefault("CI", "true")  # viewers started from here neither phone home nor greet
        import rerun as rr

        self._names = tuple(columns)
        self._scene = Scene.of(columns, start)
        self._origin_s: float | None = None
        self._end_s = 0.0
        self._last_point: FloatBlock | None = None
        tick = rr.ChunkBatcherConfig(flush_tick=PERIOD_S)
        name = str(start.get("uuid", "")) or None
        self._stream = rr.RecordingStream("lostmotion", recording_id=name, batcher_config=tick)
        self.uri = self._set_sinks(serve, file)
        title = f"{start.get('kind', 'run')} {str(start.get('utc', utc_now().isoformat()))[:19]}"
        self._stream.send_recording_name(title)
        self._stream.send_blueprint(arrange(self._scene, duration_s=None, trail_s=TRAIL_S))
        self._scene.draw_static(self._stream)
        page = rr.TextDocument(about(start), media_type=rr.MediaType.MARKDOWN)
        self._stream.log("/about", page, static=True)

    def take(self, items: Sequence[Row | Event]) -> None:
        """Shows rows and events, in the order in which they happened."""
        rows = [item for item in items if isinstance(item, tuple)]
        events = [item for item in items if isinstance(item, Event)]
        if self._origin_s is None and items:
            times = [row[self._names.index("time_s")] for row in rows]
            times += [event.time_s for event in events if event.time_s is not None]
            self._origin_s = min(times, default=0.0)
        if rows:
            self._send_rows(np.array(rows, dtype=np.float64))
        send_events(self._stream, events, self._origin_s or 0.0, self._end_s)

    def close(self) -> None:
        """Sends what is left, completes the file and ends the service."""
        self._stream.flush(timeout_sec=5)
        self._stream.disconnect()

    def _set_sinks(self, serve: bool, file: Path | None) -> str:
        import rerun as rr

        sinks: list[rr.GrpcServerSink | rr.FileSink] = []
        port = free_port() if serve else 0
        if serve:
            sinks.append(rr.GrpcServerSink(bind_ip="127.0.0.1", port=port, server_memory_limit=SERVER_MEMORY))
        if file is not None:
            file.touch()  # rerun itself would only log that it cannot write
            sinks.append(rr.FileSink(file))
        self._stream.set_sinks(*sinks)
        if not serve:
            return ""
        if not listens(port, patience_s=3.0):
            raise OSError(f"nothing answers on the view's port {port}")
        return f"rerun+http://127.0.0.1:{port}/proxy"

    def _send_rows(self, block: FloatBlock) -> None:
        columns = {name: block[:, number] for number, name in enumerate(self._names)}
        time_s = columns["time_s"] - (self._origin_s or 0.0)
        send_samples(self._stream, self._scene, time_s, columns)
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
            send_trail(self._stream, self._scene, time_s, path, size=len(path))
