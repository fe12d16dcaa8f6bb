"""A recorded run as a rerun file. The record is the truth; this is a view, and can be made again at any time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hal.errors import BadInput
from logs.arrange import arrange
from logs.feed import about, send_events, send_samples, send_whole_plane
from logs.run import Run
from logs.scene import Scene

if TYPE_CHECKING:
    import rerun as rr

TRAIL_S = 30.0


def write_rrd(run: Run, path: Path, design: Mapping[str, object] | None = None) -> Path:
    """Writes `path` from the record, replacing what is there; 1,000,000 rows take a second or two.

    `design` (a1, a2, compliance, travel) draws its curves into the plane where the record names no design of its own.

    Raises: `BadInput` for a run without samples, or when the file cannot be written.
    """
    import rerun as rr

    if run.rows == 0:
        raise BadInput(f"{run.path}: the run holds no samples ({run.reason}); there is nothing to view")
    partial = path.with_suffix(".rrd.partial")
    try:
        partial.write_bytes(b"")  # rerun itself would only log that it cannot write
    except OSError as error:
        raise BadInput(f"{path}: cannot be written ({error.strerror}); name another file") from error
    start = {**run.start, "design": design} if design and not run.start.get("design") else run.start
    scene = Scene.of(run.units, start, run.columns)
    stream = rr.RecordingStream("lostmotion", recording_id=str(run.start.get("uuid", run.name)))
    stream.set_sinks(rr.FileSink(partial))
    stream.send_recording_name(run.name)
    stream.send_blueprint(arrange(scene, duration_s=run.duration_s, trail_s=TRAIL_S))
    _send(stream, scene, run)
    stream.flush()
    stream.disconnect()
    partial.replace(path)
    return path


def _send(stream: rr.RecordingStream, scene: Scene, run: Run) -> None:
    import rerun as rr

    time_s, columns = run.columns["time_s"], run.columns
    order = np.flatnonzero(np.isfinite(time_s))
    origin_s = float(time_s[order[0]]) if order.size else 0.0
    own = time_s[order] - origin_s
    columns = {name: values[order] for name, values in columns.items()}
    states = [*(event.text for event in run.events if event.kind == "state"), "unknown"]
    scene.draw_static(stream, states)
    ending = f"\n\n## Ending\n\n{run.status}: {run.reason}\n" + "".join(f"\n- {problem}" for problem in run.problems)
    page = rr.TextDocument(about(run.start) + ending, media_type=rr.MediaType.MARKDOWN)
    stream.log("/about", page, static=True)
    send_samples(stream, scene, own, columns)
    if scene.plane is not None:
        path = np.column_stack((columns[scene.plane_x], columns[scene.position]))
        send_whole_plane(stream, scene, own, path, columns[scene.command or scene.plane_x])
    end_s = float(own[-1]) if own.size else 0.0
    send_events(stream, run.events, origin_s, end_s)
    stream.set_time("run_time", duration=end_s)
    if run.status == "crash":  # what became of the valve, the record does not say
        stream.log("/state/bench", rr.StateChange(state="unknown"))
    if run.reason not in [event.text for event in run.events]:
        level = "INFO" if run.status == "success" else "WARN" if run.status == "abort" else "ERROR"
        stream.log("/log/end", rr.TextLog(f"{run.status}: {run.reason}", level=level))
