"""Nyquist curves against -1 / N(A): amplitudes and frequencies marked, intersections named."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from app.gallery.figure import RED
from control.analysis.describing import play_describing_function
from control.analysis.limit_cycle import predict
from control.analysis.loop import LinearLoop, thesis_loop
from control.design import DesignModel

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WINDOW = (-4.0, 1.5)
MARKED_PSI = (1.6, 2.0, 3.0, 6.0)
MARKED_RAD_S = (0.2, 1.0)
TITLES = {"p": "P, positional", "p_incremental": "P, incremental", "pi": "PI"}


def draw_nyquist(loops: Sequence[LinearLoop], design: DesignModel, path: Path) -> None:
    """Nyquist curves of loops and -1 / N(A) into a file, a panel for each law."""
    from matplotlib.figure import Figure as Canvas

    laws = list(dict.fromkeys(loop.law for loop in loops))
    most = max(sum(loop.law == law for loop in loops) for law in laws)
    canvas = Canvas(figsize=(1.2 + 4.2 * len(laws), 5.6 + 0.3 * most), dpi=100, layout="constrained")
    for axes, law in zip(canvas.subplots(1, len(laws), squeeze=False)[0], laws, strict=True):
        nyquist(axes, [loop for loop in loops if loop.law == law], design)
        axes.set_title(TITLES[law], fontsize=9)
    canvas.savefig(path)


def nyquist(axes: Axes, loops: Sequence[LinearLoop], design: DesignModel) -> None:
    """Curves of loops times the play's slope, in colours of their own, and -1 / N(A) of a play of slope 1.

    Where they meet there is a dot, full where the limit cycle is stable, and the legend gives A and omega.
    """
    from matplotlib import colormaps

    _axes(axes)
    for number, loop in enumerate(loops):
        colour = colormaps["viridis"](0.85 * number / max(len(loops) - 1, 1))
        line = _scaled(loop, loop.frequencies(6000), design)
        cycles = predict(loop, design)
        shown = [cycle for cycle in cycles if cycle.stable] or cycles
        meets = [f"A = {c.pressure_psi:.2f} psi, {c.omega:.2f} rad/s" for c in shown[-1:]]
        axes.plot(line.real, line.imag, color=colour, lw=1.1, label="\n   ".join([label(loop), *meets]))
        marks = _scaled(loop, np.array(MARKED_RAD_S), design)
        axes.plot(marks.real, marks.imag, ls="", marker="|", ms=6, color=colour)
        if number == len(loops) - 1:
            _name(axes, marks, [f"{w:g} rad/s" for w in MARKED_RAD_S], colour)
        for cycle in cycles:
            at = _scaled(loop, np.array([cycle.omega]), design)
            filled = colour if cycle.stable else "white"
            axes.plot(at.real, at.imag, ls="", marker="o", ms=5, mec=colour, mfc=filled, zorder=4)
    _play(axes, design)
    axes.legend(frameon=False, fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.2))


def label(loop: LinearLoop) -> str:
    """The loop in words, with units."""
    if loop == thesis_loop():
        return "1 / (2.7 s + 1)"
    words = f"{TITLES[loop.law]}, Kp {loop.kp:g} psi/in"
    words += f", Ki {loop.ki:g} psi/(in s)" if loop.law == "pi" else ""
    words += f", dead time {loop.dead_time_s:g} s" if loop.dead_time_s else ""
    return words + (f", reading {loop.late_s:g} s late" if loop.late_s else "")


def _scaled(loop: LinearLoop, omega: np.typing.NDArray[np.float64], design: DesignModel) -> np.typing.NDArray[
    np.complex128
]:  # fmt: skip
    return np.asarray(loop(omega) * (1.0 if loop == thesis_loop() else design.compliance))


def _play(axes: Axes, design: DesignModel) -> None:
    amplitude = 0.5 * design.deadband * (1.0 + np.geomspace(1e-3, 50.0, 400))
    inverse = -1.0 / play_describing_function(amplitude, design.deadband, 1.0)
    axes.plot(inverse.real, inverse.imag, color=RED, lw=1.4, label="-1 / N(A), the play")
    marked = np.array(MARKED_PSI) * design.deadband / 2.96
    at = -1.0 / play_describing_function(marked, design.deadband, 1.0)
    axes.plot(at.real, at.imag, ls="", marker="s", ms=3, color=RED)
    _name(axes, at, [f"A = {a:.2g} psi" for a in marked], RED, left=True)


def _name(
    axes: Axes, at: np.typing.NDArray[np.complex128], names: Sequence[str], colour: Any, left: bool = False
) -> None:
    for point, name in zip(at, names, strict=True):
        if WINDOW[0] < point.real < WINDOW[1] and WINDOW[0] < point.imag < 1.0:
            place: Any = {"xytext": (-4 if left else 4, -8), "textcoords": "offset points"}
            side = "right" if left else "left"
            axes.annotate(name, (point.real, point.imag), fontsize=6, color=colour, ha=side, **place)


def _axes(axes: Axes) -> None:
    axes.set(xlim=WINDOW, ylim=(WINDOW[0], 1.0), aspect="equal", xlabel="real part", ylabel="imaginary part")
    axes.axhline(0.0, color="0.85", lw=0.6, zorder=0)
    axes.axvline(0.0, color="0.85", lw=0.6, zorder=0)
