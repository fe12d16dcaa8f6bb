"""The pressure/position plane for rerun, which has no XY plot: a 2D view in which one transform knows the scales.

Everything below `Plane.root` is logged in engineering units; the frame, its ticks and its labels are drawn by us.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from logs.recording import FloatArray

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

Colour = tuple[int, int, int]
GRID: Colour = (62, 66, 72)
WORDS: Colour = (150, 156, 164)
HEIGHT = 100.0  # of the frame, in the view's own units
BACKGROUND = (17, 19, 22)


@dataclass(frozen=True, slots=True)
class Plane:
    """A frame from `x[0]`..`x[1]` to the right and `y[0]`..`y[1]` upward, in the units that the labels name."""

    x: tuple[float, float]
    y: tuple[float, float]
    x_label: str
    y_label: str
    root: str = "/plane"
    aspect: float = 1.5

    @property
    def scales(self) -> tuple[float, float]:
        """View units per unit of x and of y."""
        return HEIGHT * self.aspect / (self.x[1] - self.x[0]), HEIGHT / (self.y[1] - self.y[0])

    def draw_frame(self, stream: rr.RecordingStream) -> None:
        """Logs the transform, grid, ticks and labels; once, static."""
        import rerun as rr

        sx, sy = self.scales
        place = rr.Transform3D(translation=[-self.x[0] * sx, self.y[1] * sy, 0], scale=[sx, -sy, 1.0])
        stream.log(self.root, place, static=True)
        xt, yt = nice_ticks(*self.x), nice_ticks(*self.y)
        strips = [[(x, self.y[0]), (x, self.y[1])] for x in xt] + [[(self.x[0], y), (self.x[1], y)] for y in yt]
        thin = rr.Radius.ui_points(0.5)
        grid = rr.LineStrips2D(strips, colors=GRID, radii=thin, draw_order=-10.0)
        stream.log(f"{self.root}/frame/grid", grid, static=True)
        dx, dy = self.x[1] - self.x[0], self.y[1] - self.y[0]
        below, left = self.y[0] - 0.02 * dy, self.x[0] - 0.035 * dx
        ticks = [(x, below) for x in xt] + [(left, y + 0.025 * dy) for y in yt]
        self._words(stream, "ticks", ticks, [f"{value:g}" for value in (*xt, *yt)])
        names = [(self.x[0] + 0.5 * dx, self.y[0] - 0.10 * dy), (self.x[0] + 0.06 * dx, self.y[1] + 0.075 * dy)]
        self._words(stream, "labels", names, [self.x_label, self.y_label])

    def _words(
        self, stream: rr.RecordingStream, name: str, at: Sequence[tuple[float, float]], texts: list[str]
    ) -> None:
        import rerun as rr

        points = rr.Points2D(at, labels=list(texts), show_labels=True, colors=WORDS, radii=rr.Radius.ui_points(0.0))
        stream.log(f"{self.root}/frame/{name}", points, static=True)

    def draw_line(
        self, stream: rr.RecordingStream, name: str, strips: Sequence[FloatArray], colour: Colour, width: float = 1.0
    ) -> None:
        """Logs static strips, each of shape (n, 2) in engineering units."""
        import rerun as rr

        radius = rr.Radius.ui_points(width)
        lines = rr.LineStrips2D(list(strips), colors=[colour] * len(strips), radii=radius)
        stream.log(f"{self.root}/{name}", lines, static=True)

    def name_point(
        self, stream: rr.RecordingStream, name: str, at: tuple[float, float], text: str, colour: Colour
    ) -> None:
        """Writes a word below a point, given in engineering units; static."""
        import rerun as rr

        label = rr.Points2D([at], labels=[text], show_labels=True, colors=[colour], radii=rr.Radius.ui_points(0.0))
        stream.log(f"{self.root}/{name}", label, static=True)

    def view(self, name: str, trail_s: float | None = None) -> rrb.Spatial2DView:
        """A view of the plane; with `trail_s`, /trail shows only so many seconds up to the cursor."""
        import rerun.blueprint as rrb

        width = HEIGHT * self.aspect
        bounds = rrb.VisualBounds2D(x_range=[-0.11 * width, 1.04 * width], y_range=[-0.14 * HEIGHT, 1.16 * HEIGHT])
        overrides: dict[rr.encodings.EntityPath | str, rrb.VisibleTimeRanges] = {}
        if trail_s is not None:
            window = rrb.VisibleTimeRange(
                "run_time",
                start=rrb.TimeRangeBoundary.cursor_relative(seconds=-trail_s),
                end=rrb.TimeRangeBoundary.cursor_relative(),
            )
            overrides = {f"{self.root}/trail": rrb.VisibleTimeRanges([window])}
        return rrb.Spatial2DView(
            origin="/",
            contents=[f"{self.root}/**"],
            name=name,
            visual_bounds=bounds,
            background=list(BACKGROUND),
            overrides=overrides,
        )


def nice_ticks(low: float, high: float, about: int = 7) -> list[float]:
    """Round numbers inside low..high, about as many as asked for."""
    raw = (high - low) / about
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if factor * power >= raw * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(number * step, 12) + 0.0 for number in range(first, last + 1)]


def design_curves(design: Mapping[str, object]) -> dict[str, FloatArray] | None:
    """The closing and the opening line of a design, shape (4, 2) each as (pressure, position); None without numbers.

    `design` holds a1, a2, compliance and travel, by themselves or in a table "valve".
    """
    inner = design.get("valve", design)
    if not isinstance(inner, Mapping):
        return None
    numbers = [inner.get(key) for key in ("a1", "a2", "compliance", "travel")]
    if not all(isinstance(each, int | float) and not isinstance(each, bool) for each in numbers):
        return None
    a1, a2, compliance, travel = (float(each) for each in numbers)  # type: ignore[arg-type]
    stroke = travel / compliance

    def line(start: float) -> FloatArray:
        return np.array([[start - 3.0, 0.0], [start, 0.0], [start + stroke, travel], [start + stroke + 3.0, travel]])

    return {"closing": line(a1), "opening": line(a2)}


def by_direction(points: FloatArray, driver: FloatArray) -> dict[str, list[FloatArray]]:
    """Cuts a path (n, 2) into the stretches in which `driver` (n,) rises and falls; neighbours share a point.

    The driver is best the command, which has no noise.
    """
    if len(points) < 2:
        return {"rising": [], "falling": []}
    steps = np.sign(np.diff(driver))
    moving = np.flatnonzero(steps)
    if moving.size:  # a still stretch belongs to the direction before it
        last = np.maximum.accumulate(np.where(steps != 0, np.arange(steps.size), moving[0]))
        steps = steps[last]
    turns = np.flatnonzero(np.diff(steps)) + 1
    edges = [0, *turns.tolist(), len(points) - 1]
    pieces: dict[str, list[FloatArray]] = {"rising": [], "falling": []}
    for start, end in pairwise(edges):
        if end > start:
            pieces["rising" if steps[start] >= 0 else "falling"].append(points[start : end + 1])
    return pieces
