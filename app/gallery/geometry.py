"""Figures 3-5, 3-8 and 3-9: the geometry of the two curves that the If-Then rule lives on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from app.gallery.figure import BLUE, GREY, RED, Entry, Number
from app.gallery.record import Sweep
from control.design import DesignModel
from control.if_then import threshold_line_psi

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

DESIGN = DesignModel()


def figure_3_5() -> Entry:
    """The two pressure steps, as a test on the valve."""
    start_in, end_in = 0.20, 0.30
    small_psi = (end_in - start_in) / DESIGN.compliance
    large_psi = small_psi + DESIGN.deadband
    high, low = (onset + start_in / DESIGN.compliance for onset in (DESIGN.a1, DESIGN.a2))
    tests = {
        "small step from the high pressure": _test((5.0, high), small_psi),
        "small step from the low pressure": _test((14.0, low), small_psi),
        "large step from the low pressure": _test((14.0, low), large_psi),
    }

    return Entry(
        "3-5",
        "Figure 3-5: the two pressure steps, as a test",
        "The same move needs a small step from the high pressure and one larger by the deadband from the low one.",
        "From 0.20 in to 0.30 in; the steps are sent to the virtual valve.",
        (
            Number("small step (1)", None, small_psi, "psi", 2),
            Number("large step (2)", None, large_psi, "psi", 2),
            *(Number(f"{name} moves", None, _move(test), "in", 3) for name, test in tests.items()),
        ),
        lambda canvas: _draw_steps(canvas, (start_in, end_in), (low, high), (small_psi, large_psi)),
        command=tests["large step from the low pressure"].command(),
    )


def _draw_steps(
    canvas: Canvas, places_in: tuple[float, float], pressures: tuple[float, float], steps_psi: tuple[float, float]
) -> None:
    """The two curves; from the low and the high pressure of the first place, the steps to the second."""
    (start_in, end_in), (low, high), (small_psi, large_psi) = places_in, pressures, steps_psi
    axes = canvas.subplots()
    x, arrow = np.array([0.0, DESIGN.travel]), {"arrowstyle": "->", "color": GREY, "shrinkA": 0.0, "shrinkB": 0.0}
    for edge, colour, name in ((DESIGN.a1, BLUE, "closing curve"), (DESIGN.a2, RED, "opening curve")):
        axes.plot(edge + x / DESIGN.compliance, x, color=colour, lw=1.0, label=name)
    axes.plot([high, low], [start_in] * 2, "o", color=GREY, ms=5, label="before")
    axes.plot([high + small_psi], [end_in], "s", color=GREY, ms=5, label="after")
    axes.annotate("", (high + small_psi, start_in), (high, start_in), arrowprops=arrow)
    axes.text(high + small_psi + 0.06, start_in, f"step 1: {small_psi:.2f} psi", va="center", fontsize=8)
    axes.annotate("", (low + large_psi, start_in - 0.04), (low, start_in - 0.04), arrowprops=arrow)
    axes.text(low + 0.4 * large_psi, start_in - 0.08, f"step 2: {large_psi:.2f} psi", ha="center", fontsize=8)
    axes.plot([low, low], [start_in - 0.04, start_in], color=GREY, lw=0.8, ls=":")
    axes.plot([high + small_psi] * 2, [start_in - 0.04, end_in], color=GREY, lw=0.8, ls=":")
    axes.set(xlabel="pressure [psi]", ylabel="position [in]")
    axes.legend(frameon=False, fontsize=8, loc="upper left")


def _test(before: tuple[float, float], step_psi: float) -> Sweep:
    """A pressure that puts the stem on one side of the play, the one before the step, the one after it."""
    levels = (*before, before[1] + step_psi)
    return Sweep("points", {"points": [[round(level, 4), 0.0, 40.0] for level in levels]})


def _move(test: Sweep) -> float:
    run = test.record()
    return float(run.position[-100:].mean() - run.position[700:800].mean())


def figure_3_9() -> Entry:
    """The two thresholds."""
    x = np.linspace(0.0, DESIGN.travel, 50)
    line = np.array([threshold_line_psi(v, DESIGN.compliance, DESIGN.a1, DESIGN.a2) for v in x])
    low, high = float(line[0] - DESIGN.a2), float(DESIGN.a1 + x[-1] / DESIGN.compliance - line[-1])

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.plot(DESIGN.a1 + x / DESIGN.compliance, x, color=BLUE, lw=1.2, label="closing curve")
        axes.plot(DESIGN.a2 + x / DESIGN.compliance, x, color=RED, lw=1.2, label="opening curve")
        axes.axvline(8.12, color=GREY, lw=1.0, label="8.12 psi (3-8)")
        axes.plot(line, x, color=GREY, lw=1.0, ls="--", label="line (3-9)")
        axes.set(xlabel="pressure [psi]", ylabel="position [in]")
        axes.legend(frameon=False, fontsize=8)

    return Entry(
        "3-9",
        "Figures 3-8 and 3-9: constant threshold and threshold line",
        "The distance to a constant threshold depends on the position; the distance to the line does not.",
        "The line is half a deadband away from both curves everywhere.",
        (
            Number("distance to the opening curve", None, low, "psi", 2),
            Number("distance to the closing curve", None, high, "psi", 2),
        ),
        draw,
    )
