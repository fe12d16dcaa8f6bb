"""The diagnosis over time as a rerun file: what was measured and predicted, where it errs, and the verdict."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hal.errors import BadInput
from logs.plane import Plane
from logs.recording import FloatArray
from twin.diagnosis import Diagnosis
from twin.report.series import IntArray, Series, thin, thin_together
from twin.report.story import story
from twin.where.regime import REGIMES, classify

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

Colour = tuple[int, int, int]
MEASURED: Colour = (190, 198, 208)
QUIET: Colour = (104, 112, 122)
BEFORE: Colour = (240, 140, 46)
RETUNED: Colour = (166, 140, 230)
AFTER: Colour = (38, 190, 180)
FLOOR: Colour = (96, 108, 120)
COMMAND: Colour = (110, 168, 254)
_STATES = {"deadband": 0x78909CFF, "moving": 0x66BB6AFF, "reversal": 0xFFB74DFF, "end_stop": 0xBA68C8FF}
_HELD = {"held out in turn": 0x26BEB4FF, "not counted": 0x455A64FF}
_PLANE_POINTS = 40_000
_LINE_POINTS = 60_000  # more than any screen shows, and a file of a few MB however long the record
_TRAIL_S = 30.0
_STRIP = 12


def write_rrd(diagnosis: Diagnosis, series: Series, path: Path) -> Path:
    """Writes `path`, replacing what is there; the rows of all recordings follow each other on one time line.

    Raises: `BadInput` for a series without rows, or when the file cannot be written.
    """
    import rerun as rr

    if series.time_s.size == 0:
        raise BadInput(f"{path}: there are no rows to show; diagnose a recording with samples")
    partial = path.with_suffix(".rrd.partial")
    try:
        partial.write_bytes(b"")  # rerun itself would only log that it cannot write
    except OSError as error:
        raise BadInput(f"{path}: cannot be written ({error.strerror}); name another file") from error
    stream = rr.RecordingStream("lostmotion_diagnosis", recording_id="diagnosis")
    stream.set_sinks(rr.FileSink(partial))
    stream.send_recording_name(f"diagnosis: {diagnosis.verdict.replace('_', ' ')}")
    plane = _plane(series)
    time = series.run_time_s
    stream.send_blueprint(_blueprint(plane, float(time[-1])))
    stream.log(
        "/story", rr.TextDocument(story(diagnosis, series.position_unit), media_type=rr.MediaType.MARKDOWN), static=True
    )
    _send_lines(stream, diagnosis, series, time)
    _send_states(stream, diagnosis, series, time)
    _send_plane(stream, plane, series, time)
    stream.flush()
    stream.disconnect()
    partial.replace(path)
    return path


def _send_lines(stream: rr.RecordingStream, diagnosis: Diagnosis, series: Series, time: FloatArray) -> None:
    """Drive, position, residual and running error, each a wide entity with names and colours."""
    error = {"design model": series.before, "re-tuned": series.retuned, "updated model": series.after}
    colours = {"design model": BEFORE, "re-tuned": RETUNED, "updated model": AFTER}
    models = {label: series.percent(values) for label, values in error.items() if values is not None}
    position = series.percent(series.position)
    floor = np.full(time.size, diagnosis.gap.noise_floor)
    rows = np.union1d(thin(position, _LINE_POINTS), thin(position - models["design model"], _LINE_POINTS))
    drive = {"command": series.command} | ({} if series.pressure is None else {"pressure": series.pressure})
    residual = {label: position - values for label, values in models.items()}
    _send(stream, "/drive", time, rows, drive, [COMMAND, MEASURED])
    _send(stream, "/position", time, rows, {"measured": position} | models, [MEASURED, *(colours[m] for m in models)])
    band = {"floor +2 sigma": 2.0 * floor, "floor -2 sigma": -2.0 * floor}
    _send(stream, "/residual", time, rows, residual | band, [*(colours[m] for m in residual), FLOOR, FLOOR])
    running = {label: _running_rms(values) for label, values in residual.items()}
    _send(stream, "/running", time, rows, running | {"floor": floor}, [*(colours[m] for m in running), FLOOR])


def _send(
    stream: rr.RecordingStream,
    entity: str,
    time: FloatArray,
    rows: IntArray,
    lines: dict[str, FloatArray],
    colours: list[Colour],
) -> None:
    """Those rows of a few lines that share a plot."""
    import rerun as rr

    names = list(lines)
    style = rr.SeriesLines(names=names, colors=colours[: len(names)], widths=[1.5] * len(names))
    stream.log(entity, style, static=True)
    block = np.column_stack([values[rows] for values in lines.values()])
    index = [rr.TimeColumn("run_time", duration=time[rows])]
    stream.send_columns(entity, indexes=index, columns=rr.Scalars.columns(scalars=block))


def _send_states(stream: rr.RecordingStream, diagnosis: Diagnosis, series: Series, time: FloatArray) -> None:
    """Held-out stretches, and the regime of the stem as the where-map counts it."""
    driver = series.command if series.pressure is None else series.pressure
    sigma = diagnosis.gap.noise_floor * series.travel / 100.0
    reading = series.position if series.false is None else np.where(series.false, np.nan, series.position)
    if time.size > 1:
        regime = classify(time, reading, series.before, driver, sigma, series.travel).regime
        _changes(stream, "/state/regime", time, [list(REGIMES)[code] for code in regime], _STATES)
    held = ["held out in turn" if flag else "not counted" for flag in series.heldout]
    _changes(stream, "/state/data", time, held, _HELD)


def _changes(
    stream: rr.RecordingStream, entity: str, time: FloatArray, states: list[str], colours: dict[str, int]
) -> None:
    import rerun as rr

    words = rr.StateConfiguration(
        values=list(colours),
        labels=[state.replace("_", " ") for state in colours],
        colors=np.array(list(colours.values()), dtype=np.uint32),
    )
    stream.log(entity, words, static=True)
    names = np.array(states)
    at = np.flatnonzero(np.concatenate([[True], names[1:] != names[:-1]]))
    index = [rr.TimeColumn("run_time", duration=time[at])]
    stream.send_columns(entity, indexes=index, columns=rr.StateChange.columns(state=names[at].tolist()))


def _plane(series: Series) -> Plane:
    driver = series.command if series.pressure is None else series.pressure
    low, high = float(np.nanmin(driver)), float(np.nanmax(driver))
    margin = 0.04 * (high - low) or 1.0
    name = "command" if series.pressure is None else "pressure"
    return Plane(
        x=(low - margin, high + margin),
        y=(-6.0, 106.0),
        x_label=f"{name} [{series.pressure_unit}]",
        y_label="position [% of travel]",
    )


def _send_plane(stream: rr.RecordingStream, plane: Plane, series: Series, time: FloatArray) -> None:
    """Readings, design and updated model as static loops, and the point that the run has reached with its trail."""
    import rerun as rr

    driver = series.command if series.pressure is None else series.pressure
    plane.draw_frame(stream)
    loops = (
        ("measured", QUIET, series.position, 2.4, 0.0),
        ("design", BEFORE, series.before, 0.7, 1.0),
        ("updated", AFTER, series.after, 0.7, 2.0),
    )
    lines = [driver, *(series.percent(values) for _, _, values, _, _ in loops)]
    rows = thin_together(lines, _PLANE_POINTS)
    for (label, colour, _, width, order), percent in zip(loops, lines[1:], strict=True):
        strips = _strips(driver, percent, rows, series)
        if strips:
            radius = rr.Radius.ui_points(width)
            loop = rr.LineStrips2D(strips, colors=[colour] * len(strips), radii=radius, draw_order=order)
            stream.log(f"{plane.root}/loop/{label}", loop, static=True)
    path = np.column_stack([driver, series.percent(series.position)])
    good = np.flatnonzero(np.isfinite(path).all(axis=1))
    good = good[:: max(1, -(-good.size // _PLANE_POINTS))]
    if good.size < 2:
        return
    path, time = path[good], time[good]
    ends = np.arange(_STRIP, len(path) - 1 + _STRIP, _STRIP).clip(max=len(path) - 1)
    index = [rr.TimeColumn("run_time", duration=time[ends])]
    strips = [path[max(0, end - _STRIP) : end + 1] for end in ends]
    radii = np.full(len(strips), -1.6)  # negative: points of the screen
    trail = rr.LineStrips2D.columns(strips=strips, colors=[(255, 255, 255)] * len(strips), radii=radii)
    stream.send_columns(f"{plane.root}/trail", indexes=index, columns=trail)
    now = rr.Points2D.columns(positions=path[ends], colors=[(255, 255, 255)] * len(strips), radii=3.0 * radii)
    stream.send_columns(f"{plane.root}/now", indexes=index, columns=now)


def _strips(x: FloatArray, y: FloatArray, rows: IntArray, series: Series) -> list[FloatArray]:
    """The path through those rows as strips without gaps: cut at missing values and between recordings."""
    path = np.column_stack([x, y])[rows]
    known = np.isfinite(path).all(axis=1)
    part = np.cumsum(~known) + np.cumsum(series.starts)[rows]
    cuts = np.flatnonzero(np.diff(part[known])) + 1
    return [piece for piece in np.split(path[known], cuts) if len(piece) > 1]


def _running_rms(residual: FloatArray, rows: int = 200) -> FloatArray:
    """RMS over the last `rows` known rows."""
    known = np.isfinite(residual)
    total = np.concatenate([[0.0], np.cumsum(np.where(known, residual**2, 0.0))])
    count = np.concatenate([[0.0], np.cumsum(known)])
    at = np.arange(1, residual.size + 1)
    since = np.maximum(at - rows, 0)
    return np.asarray(np.sqrt(np.maximum(total[at] - total[since], 0.0) / np.maximum(count[at] - count[since], 1.0)))


def _blueprint(plane: Plane, duration_s: float) -> rrb.Blueprint:
    import rerun.blueprint as rrb

    edge = rrb.TimeRangeBoundary
    span = rrb.TimeRange(start=edge.absolute(seconds=-0.01 * duration_s), end=edge.absolute(seconds=1.02 * duration_s))
    axis = rrb.TimeAxis(link="Independent", view_range=span)
    legend = rrb.PlotLegend(corner=rrb.Corner2D.LeftTop)

    def plot(entity: str, title: str) -> rrb.TimeSeriesView:
        return rrb.TimeSeriesView(origin=entity, name=title, axis_x=axis, plot_legend=legend)

    left = rrb.Vertical(
        plot("/drive", "Command and pressure"),
        plot("/position", "Position [% of travel]"),
        plot("/residual", "Reading - model [% of travel]"),
        plot("/running", "RMS error of the last 200 rows [% of travel]"),
        rrb.StateTimelineView(origin="/state", contents="/state/**", name="Regime and held-out data", time_view=axis),
        row_shares=[1.5, 3.0, 2.4, 1.7, 1.6],
    )
    right = rrb.Vertical(
        plane.view("Hysteresis plane", _TRAIL_S),
        rrb.TextDocumentView(origin="/story", name="Verdict"),
        row_shares=[1.1, 1.0],
    )
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[1.45, 1]),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline="run_time", play_state="paused"),
        auto_layout=False,
        auto_views=False,
    )
