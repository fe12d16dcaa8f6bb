"""Section 2.3: Nyquist curve, describing function, and what converter lag, delay and sampling change."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gallery.figure import BLUE, GREEN, ORANGE, RED, Entry, Number
from app.hunting import PI_GAINS, Case, study
from control.analysis.describing import play_describing_function, play_numerically
from control.analysis.limit_cycle import predict
from control.analysis.loop import LinearLoop, thesis_loop
from control.design import DesignModel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

DESIGN = DesignModel()
LOOPS = (
    LinearLoop("p", 3.0),
    LinearLoop("p_incremental", 1.0),
    LinearLoop("p_incremental", 3.0),
    LinearLoop("p_incremental", 4.0),
    *(LinearLoop("pi", kp, ki) for kp, ki in PI_GAINS[:5]),
)


def draw_nyquist(loops: Sequence[LinearLoop], design: DesignModel, path: Path) -> None:
    """Nyquist curves of loops (times the play's slope) and -1 / N(A), into a file."""
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=(7.0, 4.5), dpi=100, layout="constrained")
    _curves(canvas.subplots(), loops, design, ((-4.0, 1.5), (-4.0, 1.5)))
    canvas.savefig(path)


def _curves(
    axes: Axes,
    loops: Sequence[LinearLoop],
    design: DesignModel,
    window: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    colours = (BLUE, ORANGE, GREEN, "#7a4fa3", "#444444")
    for loop, colour in zip(loops, colours * len(loops), strict=False):
        omega = np.geomspace(1e-3, np.pi / loop.tick_s if loop.tick_s else 1e3, 3000)
        line = loop(omega) * (1.0 if loop == thesis_loop() else design.compliance)
        name = "1 / (2.7 s + 1)" if loop == thesis_loop() else f"{loop.law} {loop.kp:g} {loop.ki or ''}".strip()
        axes.plot(line.real, line.imag, color=colour, lw=1.2, label=name)
    amplitude = 0.5 * design.deadband * (1.0 + np.geomspace(1e-3, 50.0, 400))
    inverse = -1.0 / play_describing_function(amplitude, design.deadband, 1.0)
    axes.plot(inverse.real, inverse.imag, color=RED, lw=1.2, label="-1 / N(A)")
    axes.set(xlim=window[0], ylim=window[1], xlabel="real", ylabel="imaginary")
    axes.axhline(0.0, color="0.85", lw=0.6, zorder=0)
    axes.axvline(0.0, color="0.85", lw=0.6, zorder=0)
    axes.legend(frameon=False, fontsize=7)


def figure_2_8() -> Entry:
    """The thesis's conclusion, and its limits."""
    cases = study(LOOPS, DESIGN)
    amplitude = 3.0
    closed = complex(play_describing_function(np.array([amplitude]), DESIGN.deadband, DESIGN.compliance)[0])
    sampled = play_numerically(amplitude, DESIGN.deadband, DESIGN.compliance)

    def draw(canvas: Canvas) -> None:
        left, right = canvas.subplots(1, 2)
        _curves(left, [thesis_loop()], DESIGN, ((-4.0, 1.5), (-4.0, 0.8)))
        _curves(right, [LOOPS[0], LOOPS[1], LOOPS[2], LOOPS[6]], DESIGN, ((-4.0, 1.5), (-4.0, 0.8)))
        left.set_title("as in the thesis", fontsize=9)
        right.set_title("with lag, delay and sampling", fontsize=9)

    return Entry(
        "2-8",
        "Figure 2-8: Nyquist curve and describing function",
        "The first-order curve stays in the right half plane and never meets -1 / N(A): no limit cycle. Higher-order "
        "terms might change that.",
        "They do. One lag alone never hunts, as the thesis says. The positional P law does not hunt with converter "
        "lag, a tick of delay and sampling either. But the incremental law of figure 3-1 has an accumulator in it, and "
        "a PI law an integrator, and both meet -1 / N(A) when their gain is large enough. Kp = 3 psi/in, the thesis's "
        "own value, lies beyond that border in the incremental reading, which is what figure 3-2 shows. Where the "
        "stem's rate limit of 0.12 in/s takes part, the describing function of the play alone is too small; the "
        "harmonic balance, which has play and rate limit in the time domain, is right there too. (The largest "
        "oscillations measured are a little smaller than balanced, because the bench ends at 0 and 20 psi. Just below "
        "the border, `pi` with Ki = 6, the valve hunts although the describing function says no: one harmonic is not "
        "all of it.)",
        (
            Number("limit cycles of the thesis's loop", 0.0, float(len(predict(thesis_loop(), DESIGN))), "", 0),
            Number(
                "|N|(3 psi), closed form against sampled", None, abs(closed - sampled) / abs(closed) * 100.0, "% off", 4
            ),
            *(number for case in cases for number in _numbers(case)),
        ),
        draw,
        command="lostmotion analyse",
    )


def _numbers(case: Case) -> list[Number]:
    name = f"{case.loop.law} Kp {case.loop.kp:g}" + (f" Ki {case.loop.ki:g}" if case.loop.ki else "")
    found = (("describing function", case.predicted), ("harmonic balance", case.balanced), ("measured", case.measured))
    numbers = []
    for how, cycle in found:
        swing = 200.0 * cycle.stem_in / DESIGN.travel if cycle else 0.0
        numbers.append(Number(f"{name}: swing, {how}", None, swing, "% of travel", 1))
        if cycle:
            numbers.append(Number(f"{name}: period, {how}", None, cycle.period_s, "s", 1))
    return numbers
