"""The thesis's block diagrams, drawn in our words: figures 2-3, 2-6, 3-1, 3-3, 3-6 and 3-11."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from app.gallery.figure import BLUE, GREY, Entry

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

HALF = 0.38  # of a block's width and height

CHAINS: tuple[tuple[str, str, tuple[str, ...], bool, str], ...] = (
    (
        "2-3",
        "Figure 2-3: steady-state model",
        ("pressure\n[psi]", "- offset\n7.30 psi", "play\n2.96 psi", "x k_eq\n0.19 in/psi", "position\n[in]"),
        False,
        "`w = max(k (p - a1), min(k (p - a2), w))`",
    ),
    (
        "2-6",
        "Figure 2-6: complete open-loop model",
        (
            "command",
            "E/P lag\n0.30 s",
            "offset, play,\nx k_eq",
            "stops\n0 ... 0.5625 in",
            "lag 2.7 s,\n0.12 in/s",
            "position",
        ),
        False,
        "The play is held inside the stops, so that the rate limiter does not wind up; `lostmotion simulate`.",
    ),
    (
        "3-1",
        "Figures 3-1 and 3-3: P and PI control",
        ("target", "error", "Kp\n(+ Ki / s)", "+ bias, or\n+ P_meas", "valve", "position"),
        True,
        "`p` adds the bias, `p_incremental` the measured pressure; `pi`, `pi_antiwindup`.",
    ),
    (
        "3-6",
        "Figures 3-6 and 3-11: If-Then control, and with PI",
        ("target", "error", "side of the\nthreshold?", "P_meas + g e\n(+- deadband)\n(+ I)", "valve", "position"),
        True,
        "`if_then_constant`, `if_then_line`, `if_then_pi`.",
    ),
)


def entries() -> list[Entry]:
    """One entry per diagram."""
    return [
        Entry(key, title, "A block diagram.", found, draw=_drawer(blocks, feedback), size_in=(7.2, 1.5))
        for key, title, blocks, feedback, found in CHAINS
    ]


def _drawer(blocks: Sequence[str], feedback: bool):  # type: ignore[no-untyped-def]
    def draw(canvas: Canvas) -> None:
        from matplotlib.patches import Rectangle

        axes = canvas.subplots()
        axes.set(xlim=(-0.5, len(blocks) - 0.5), ylim=(-0.85, 0.45))
        axes.axis("off")
        arrow = {"arrowstyle": "->", "color": GREY, "lw": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
        for place, text in enumerate(blocks):
            edge = GREY if place in (0, len(blocks) - 1) else BLUE
            axes.add_patch(Rectangle((place - HALF, -HALF), 2.0 * HALF, 2.0 * HALF, fc="white", ec=edge, lw=1.0))
            axes.text(place, 0.0, text, ha="center", va="center", fontsize=8)
            if place:
                axes.annotate("", (place - HALF, 0.0), (place - 1.0 + HALF, 0.0), arrowprops=arrow)
        if feedback:
            last = len(blocks) - 1
            axes.plot([last, last, 1, 1], [-HALF, -0.75, -0.75, -HALF - 0.15], color=GREY, lw=1.0)
            axes.annotate("", (1, -HALF), (1, -HALF - 0.2), arrowprops=arrow)
            axes.text(0.5 * (last + 1), -0.71, "LVDT (and measured pressure)", ha="center", va="bottom", fontsize=7)

    return draw
