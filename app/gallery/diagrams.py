"""The thesis's block diagrams, drawn in our words: figures 2-3, 2-6, 3-1, 3-3, 3-6 and 3-11."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from app.gallery.figure import BLUE, GREY, Entry

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

HALF = 0.38  # of a block's width and height

# From which block to which, in the order of the chain, and what goes there; lines lie one below the other.
Back = tuple[int, int, str]
FEEDBACK: tuple[Back, ...] = ((4, 3, "measured pressure"), (5, 1, "measured position (LVDT)"))

CHAINS: tuple[tuple[str, str, tuple[str, ...], tuple[Back, ...], str], ...] = (
    (
        "2-3",
        "Figure 2-3: steady-state model",
        ("pressure\n[psi]", "- offset\n7.30 psi", "play\n2.96 psi", "x k_eq\n0.19 in/psi", "position\n[in]"),
        (),
        "`w = max(k (p - a1), min(k (p - a2), w))`",
    ),
    (
        "2-6",
        "Figure 2-6: complete open-loop model",
        (
            "command\n[psi]",
            "E/P lag\n0.30 s",
            "offset, play,\nx k_eq",
            "stops\n0 ... 0.5625 in",
            "lag 2.7 s,\n0.12 in/s",
            "position\n[in]",
        ),
        (),
        "The play is held inside the stops, so that the rate limiter does not wind up; `lostmotion simulate`.",
    ),
    (
        "3-1",
        "Figures 3-1 and 3-3: P and PI control",
        ("target\n[in]", "error\n[in]", "Kp\n(+ Ki / s)", "+ bias, or\n+ P_meas", "valve", "position\n[in]"),
        FEEDBACK,
        "`p` adds the bias, `p_incremental` the measured pressure; `pi`, `pi_antiwindup`.",
    ),
    (
        "3-6",
        "Figures 3-6 and 3-11: If-Then control, and with PI",
        (
            "target\n[in]",
            "error\n[in]",
            "side of the\nthreshold?",
            "P_meas + g e\n(+- deadband)\n(+ I)",
            "valve",
            "position\n[in]",
        ),
        ((4, 3, "measured pressure"), (4, 2, ""), (5, 1, "measured position (LVDT)"), (5, 2, "")),
        "`if_then_constant`, `if_then_line`, `if_then_pi`.",
    ),
)
BELOW = 0.3  # between the lines below the blocks


def entries() -> list[Entry]:
    """One entry per diagram."""
    return [
        Entry(key, title, "A block diagram.", found, draw=_drawer(blocks, back), size_in=(7.2, 1.9 if back else 1.2))
        for key, title, blocks, back, found in CHAINS
    ]


def _drawer(blocks: Sequence[str], back: Sequence[Back]):  # type: ignore[no-untyped-def]
    def draw(canvas: Canvas) -> None:
        from matplotlib.patches import Rectangle

        axes = canvas.subplots()
        levels = len({label for _, _, label in back if label})
        axes.set(xlim=(-0.5, len(blocks) - 0.5), ylim=(-HALF - 0.1 - BELOW * levels, HALF + 0.05))
        axes.axis("off")
        arrow = {"arrowstyle": "->", "color": GREY, "lw": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
        for place, text in enumerate(blocks):
            edge = GREY if place in (0, len(blocks) - 1) else BLUE
            axes.add_patch(Rectangle((place - HALF, -HALF), 2.0 * HALF, 2.0 * HALF, fc="white", ec=edge, lw=1.0))
            axes.text(place, 0.0, text, ha="center", va="center", fontsize=8)
            if place:
                axes.annotate("", (place - HALF, 0.0), (place - 1.0 + HALF, 0.0), arrowprops=arrow)
        _feedback(axes, back, arrow)

    return draw


def _feedback(axes: Axes, back: Sequence[Back], arrow: Mapping[str, object]) -> None:
    """Lines from below one block to below another; a line without words runs at the height of the one before it."""
    level = -HALF
    for start, end, label in back:
        level -= BELOW if label else 0.0
        # two lines that end at one block come in beside each other
        into = end + (0.15 if start == 4 else -0.15) * any(e == end and s != start for s, e, _ in back)
        axes.plot([start, start, into, into], [-HALF, level, level, -HALF - 0.12], color=GREY, lw=1.0)
        axes.annotate("", (into, -HALF), (into, -HALF - 0.15), arrowprops=dict(arrow))
        if label:
            axes.text(0.5 * (start + end), level + 0.03, label, ha="center", va="bottom", fontsize=7)
