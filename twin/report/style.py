"""Colours and drawing habits that the report's figures and its page share."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any, ParamSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

P = ParamSpec("P")

INK = "#1c2430"
MUTED = "#6b7684"
HAIR = "#dfe4ea"
MEASURED = "#3b4654"
BEFORE = "#d9741a"
RETUNED = "#8a6fc9"
AFTER = "#0b7a75"
FLOOR = "#c9d3dc"
UNCOUNTED = "#e9e6e0"

_RC: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "lostmotion",
    "font.size": 9.0,
    "axes.edgecolor": HAIR,
    "axes.labelcolor": MUTED,
    "axes.linewidth": 0.8,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.major.size": 0.0,
    "ytick.major.size": 0.0,
    "lines.solid_joinstyle": "round",
    "path.simplify": True,
    "path.simplify_threshold": 0.3,
}


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure without any global state."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_in, height_in), layout="constrained")
    FigureCanvasSVG(figure)
    return figure


def tidy(axes: Axes, x_label: str = "", y_label: str = "") -> None:
    """Hairline grid, no box, quiet labels."""
    axes.grid(True, color=HAIR, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right", "left", "bottom"):
        axes.spines[side].set_visible(False)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)


def drawn(label: str) -> Callable[[Callable[P, Figure]], Callable[P, str]]:
    """Makes a function that draws a figure return it as an inline SVG element, drawn in the report's style.

    The element scales with the page, its text stays text, and the same input gives the same bytes. `label` is what a
    screen reader says.
    """

    def decorate(draw: Callable[P, Figure]) -> Callable[P, str]:
        @wraps(draw)
        def inline(*args: P.args, **kwargs: P.kwargs) -> str:
            import matplotlib as mpl

            buffer = io.StringIO()
            with mpl.rc_context(_RC):
                draw(*args, **kwargs).savefig(buffer, format="svg", transparent=True, metadata={"Date": None})
            return _inline(buffer.getvalue(), label)

        return inline

    return decorate


def _inline(text: str, label: str) -> str:
    text = text[text.index("<svg") :]
    head, rest = text.split(">", 1)
    head = re.sub(r' (width|height)="[^"]*"', "", head)
    rest = re.sub(r"<metadata>.*?</metadata>", "", rest, flags=re.S)
    # the page's own font instead of the one that measured; no names that two figures would share; hundredths of a point
    rest = re.sub(r"font-family: [^;\"]*;? ?", "", rest)
    rest = re.sub(r"font: ([\d.]+px) [^;\"]*", r"font-size: \1", rest)
    rest = re.sub(r'<g id="[^"]*"', "<g", rest)
    rest = re.sub(r"(\d\.\d\d)\d+", r"\1", rest)
    return f'{head} role="img" aria-label="{label}">{rest.rstrip()}'
