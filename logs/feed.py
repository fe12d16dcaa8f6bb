"""Samples, words and the moving point of the plane, sent to a rerun stream in columns; live and file use the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from logs.plane import by_direction
from logs.recording import FloatArray
from logs.run import Event
from logs.scene import FALLING, MEASURED, RISING, Scene

if TYPE_CHECKING:
    import rerun as rr

LEVELS = {"info": "INFO", "warning": "WARN", "error": "ERROR"}
PLANE_POINTS = 60_000  # at most so many points of a whole run are drawn in the plane
TRAIL_STRIP = 12


def send_samples(
    stream: rr.RecordingStream, scene: Scene, time_s: FloatArray, columns: Mapping[str, FloatArray]
) -> None:
    """One block of rows; every array has shape (n,), `time_s` is the run's own time from 0."""
    import rerun as rr

    index = [rr.TimeColumn("run_time", duration=time_s)]
    for group in scene.groups:
        block = np.column_stack([columns[name] for name in group.columns])
        stream.send_columns(group.entity, indexes=index, columns=rr.Scalars.columns(scalars=block))
    if scene.target and scene.position:
        error = columns[scene.target] - columns[scene.position]
        stream.send_columns("/error", indexes=index, columns=rr.Scalars.columns(scalars=error))


def send_trail(stream: rr.RecordingStream, scene: Scene, time_s: FloatArray, path: FloatArray, size: int) -> None:
    """The path in the plane, (n, 2), as strips of `size` points that share their ends, and the point it has reached."""
    import rerun as rr

    if scene.plane is None or len(path) < 2:
        return
    ends = np.arange(size, len(path) - 1 + size, size).clip(max=len(path) - 1)
    strips = [path[max(0, end - size) : end + 1] for end in ends]
    index = [rr.TimeColumn("run_time", duration=time_s[ends])]
    count = len(strips)  # a negative radius is in points of the screen, not in view units
    stream.send_columns(
        f"{scene.plane.root}/trail",
        indexes=index,
        columns=rr.LineStrips2D.columns(strips=strips, colors=[MEASURED] * count, radii=np.full(count, -1.2)),
    )
    stream.send_columns(
        f"{scene.plane.root}/now",
        indexes=index,
        columns=rr.Points2D.columns(positions=path[ends], colors=[(255, 255, 255)] * count, radii=np.full(count, -4.5)),
    )


def send_whole_plane(
    stream: rr.RecordingStream, scene: Scene, time_s: FloatArray, path: FloatArray, command: FloatArray
) -> None:
    """A finished run in the plane: all of it, static and coloured by the command's direction, and the trail."""
    if scene.plane is None:
        return
    good = np.flatnonzero(np.isfinite(path).all(axis=1))
    good = good[:: max(1, -(-good.size // PLANE_POINTS))]
    path = path[good]
    pieces = by_direction(path, command[good])
    for name, colour in (("rising", RISING), ("falling", FALLING)):
        if pieces[name]:
            scene.plane.draw_line(stream, f"run/{name}", pieces[name], colour, 0.8)
    send_trail(stream, scene, time_s[good], path, TRAIL_STRIP)


def send_events(stream: rr.RecordingStream, events: Sequence[Event], origin_s: float, end_s: float) -> None:
    """States onto the timeline, events and notes into the log; what was noted after the end stands at the end."""
    import rerun as rr

    for event in events:
        at = end_s if event.time_s is None else event.time_s - origin_s
        stream.set_time("run_time", duration=at)
        if event.kind == "state":
            stream.log("/state/bench", rr.StateChange(state=event.text))
            continue
        text = f"note: {event.text}" if event.kind == "note" else event.text
        stream.log(f"/log/{event.kind}", rr.TextLog(text, level=LEVELS.get(event.level, "INFO")))
    stream.reset_time()


def about(start: Mapping[str, object]) -> str:
    """The start document as a page of Markdown: tables of plain values, nested ones below."""
    lines = [f"# {start.get('kind', 'run')}", ""]
    lines += _rows({key: value for key, value in start.items() if not isinstance(value, Mapping) and key != "kind"})
    for key, value in start.items():
        if isinstance(value, Mapping) and value:
            lines += ["", f"## {key.replace('_', ' ')}", "", *_rows(value)]
    return "\n".join(lines)


def _rows(values: Mapping[str, object]) -> list[str]:
    rows = ["| | |", "|---|---|"]
    for key, value in values.items():
        shown = value
        if isinstance(value, Mapping):
            shown = ", ".join(f"{name} = {each}" for name, each in value.items())
        elif isinstance(value, list | tuple):
            shown = " ".join(str(each) for each in value)
        if shown not in (None, ""):
            rows.append(f"| {key.replace('_', ' ')} | {str(shown)[:300].replace('|', '/')} |")
    return rows
