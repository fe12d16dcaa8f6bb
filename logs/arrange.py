"""How the views of a run are arranged on the screen: plots and states left, the plane and the words right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logs.scene import Scene

if TYPE_CHECKING:
    import rerun.blueprint as rrb

MAIN = ("/pressure", "/position")


def arrange(scene: Scene, window_s: float | None, trail_s: float) -> rrb.Blueprint:
    """The blueprint. With `window_s` the plots show only the last seconds, for watching a run live."""
    import rerun.blueprint as rrb

    titles = {group.entity: _title(group.entity, group.labels, group.unit) for group in scene.groups}
    plots = [_series(entity, titles[entity], window_s) for entity in MAIN if entity in titles]
    others = [_series(entity, title, window_s) for entity, title in titles.items() if entity not in MAIN]
    if scene.target:
        unit = next(group.unit for group in scene.groups if group.entity == "/position")
        plots.append(_series("/error", f"Error: target - position [{unit}]", window_s))
    shares = [3.0] * min(len(plots), 2) + [1.6] * (len(plots) - 2)
    states = rrb.StateTimelineView(origin="/state", contents="/state/**", name="Bench state")
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
        rrb.TextLogView(origin="/log", contents="/log/**", name="Events and notes"),
        rrb.TextDocumentView(origin="/about", name="About this run"),
        active_tab=0,
    )


def _title(entity: str, labels: tuple[str, ...], unit: str) -> str:
    words = " and ".join(labels) if len(labels) < 3 else entity.strip("/")
    return words[:1].upper() + words[1:] + (f" [{unit}]" if unit else "")


def _series(entity: str, title: str, window_s: float | None) -> rrb.TimeSeriesView:
    import rerun.blueprint as rrb

    ranges = None
    if window_s is not None:
        ranges = rrb.VisibleTimeRange(
            "run_time",
            start=rrb.TimeRangeBoundary.cursor_relative(seconds=-window_s),
            end=rrb.TimeRangeBoundary.cursor_relative(),
        )
    link = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    legend = rrb.PlotLegend(corner=rrb.Corner2D.RightTop)
    return rrb.TimeSeriesView(origin=entity, name=title, time_ranges=ranges, axis_x=link, plot_legend=legend)
