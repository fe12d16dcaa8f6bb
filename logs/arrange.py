"""How the views of a run are arranged on the screen: plots and states left, the plane and the words right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logs.scene import Scene

if TYPE_CHECKING:
    import rerun.blueprint as rrb

LIVE_S = 60.0
MAIN = ("/pressure", "/position")


def arrange(scene: Scene, *, duration_s: float | None, trail_s: float) -> rrb.Blueprint:
    """The blueprint of a finished run of `duration_s`, shown whole; None: of a live one, shown for its last minute."""
    import rerun.blueprint as rrb

    axis = _axis(duration_s)
    titles = {group.entity: _title(group.entity, group.labels, group.unit) for group in scene.groups}
    plots = [_series(entity, titles[entity], axis) for entity in MAIN if entity in titles]
    others = [_series(entity, title, axis) for entity, title in titles.items() if entity not in MAIN]
    if scene.target:
        unit = next(group.unit for group in scene.groups if group.entity == "/position")
        plots.append(_series("/error", f"Error: target - position [{unit}]", axis))
    shares = [3.0] * min(len(plots), 2) + [1.6] * (len(plots) - 2)
    states = rrb.StateTimelineView(origin="/state", contents="/state/**", name="Bench state", time_view=axis)
    left = rrb.Vertical(*plots, states, row_shares=[*shares, 0.9])
    plane = [scene.plane.view("Hysteresis plane", trail_s)] if scene.plane else []
    right = rrb.Vertical(*plane, _words(), row_shares=[*[3.0 for _ in plane], 2.0])
    run = rrb.Horizontal(left, right, column_shares=[1.25, 1], name="Run")
    return rrb.Blueprint(
        rrb.Tabs(run, rrb.Grid(*others, name="Bench"), active_tab=0) if others else run,
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline="run_time", play_state="following"),
        auto_layout=False,
        auto_views=False,
    )


def _words() -> rrb.Tabs:
    import rerun.blueprint as rrb

    return rrb.Tabs(
        rrb.TextLogView(origin="/log", contents="/log/**", name="Events and notes", columns=_log_columns()),
        rrb.TextDocumentView(origin="/about", name="About this run"),
        active_tab=0,
    )


def _title(entity: str, labels: tuple[str, ...], unit: str) -> str:
    words = " and ".join(labels) if len(labels) < 3 else entity.strip("/")
    return words[:1].upper() + words[1:] + (f" [{unit}]" if unit else "")


def _log_columns() -> rrb.TextLogColumns:
    """Time, level and words; where in the tree a line was logged is nobody's business."""
    import rerun.blueprint as rrb

    column = rrb.encodings.TextLogColumn
    return rrb.TextLogColumns(
        text_log_columns=[column("EntityPath", visible=False), column("LogLevel"), column("Body")]
    )


def _axis(duration_s: float | None) -> rrb.TimeAxis:
    """The time axis of every plot. A linked axis would open on half a minute around the cursor, so each has its own."""
    import rerun.blueprint as rrb

    edge = rrb.TimeRangeBoundary
    if duration_s is None:
        span = rrb.TimeRange(
            start=edge.cursor_relative(seconds=-LIVE_S), end=edge.cursor_relative(seconds=0.02 * LIVE_S)
        )
    else:
        span = rrb.TimeRange(
            start=edge.absolute(seconds=-0.01 * duration_s), end=edge.absolute(seconds=1.02 * duration_s)
        )
    return rrb.TimeAxis(link="Independent", view_range=span)


def _series(entity: str, title: str, axis: rrb.TimeAxis) -> rrb.TimeSeriesView:
    import rerun.blueprint as rrb

    legend = rrb.PlotLegend(corner=rrb.Corner2D.LeftTop)
    return rrb.TimeSeriesView(origin=entity, name=title, axis_x=axis, plot_legend=legend)
