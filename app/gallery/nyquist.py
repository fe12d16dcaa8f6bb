"""Section 2.3: Nyquist curve, describing function, and what converter lag, dead time and sampling change."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from app.gains import curves
from app.gallery.figure import BLUE, ORANGE, Entry, Number
from app.gallery.nyquist_plot import nyquist
from app.hunting import CONDITIONS, PI_GAINS, WIRED, Case, first_gain, measure_wired, measured, study
from control.analysis.describing import play_describing_function, play_numerically
from control.analysis.limit_cycle import predict
from control.analysis.loop import LinearLoop, thesis_loop
from control.design import DesignModel

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

DESIGN = DesignModel()
INCREMENTAL = LinearLoop("p_incremental", 3.0)
LOOPS = (
    LinearLoop("p", 3.0),
    *(LinearLoop("p_incremental", kp) for kp in (1.0, 2.5, 3.0, 4.0)),
    *(LinearLoop("pi", kp, ki) for kp, ki in PI_GAINS[:5]),
)
WIRED_LOOPS = (INCREMENTAL, LinearLoop("pi", 3.0, 6.0), LinearLoop("pi", 3.0, 8.0))
DEAD_TIMES_S = (0.0, 0.2, 0.5, 1.0)
GAINS = {  # where the borders are looked for, upwards
    "incremental Kp": tuple(round(0.1 * n, 1) for n in range(10, 120)),
    "PI Ki": tuple(round(0.1 * n, 1) for n in range(20, 120)),
}
SWEPT = tuple(float(kp) for kp in np.arange(2.0, 6.01, 0.5))
FOUND = (
    "They do. One lag alone never hunts, as the thesis says. The positional P law does not hunt with converter lag, a "
    "tick of delay and sampling either. But the incremental law of figure 3-1 has an accumulator in it, and a PI law "
    "an integrator, and both meet -1 / N(A) when their gain is large enough. Kp = 3 psi/in, the thesis's own value, "
    "lies beyond that border in the incremental reading. The describing function draws the border a little too far "
    "out: Kp = 2.5 and `pi` with Ki = 6 hunt although it says no, and the harmonic balance, which looks for its "
    "starting points itself, finds both. Where the stem's rate limit of 0.12 in/s takes part, the describing function "
    "of the play alone is too small; the balance has play and rate limit in the time domain."
)
DELAY = (
    "More dead time makes the PI law worse and the incremental law better. The incremental law adds Kp e to the "
    "pressure that it has *measured*, and what it added before shows there only after lag, tick and dead time: the "
    "same correction is added once per such round trip, so that its integral gain is about Kp / (lag + a tick and a "
    "half + dead time), and falls with the dead time. A PI law integrates at its own pace whatever the converter does, "
    "and dead time only costs it phase. A delay of the position reading (`--late`) is outside that round trip, and "
    "makes both worse. The borders below are the lowest gains that hunt, in steps of 0.1; the PI law has Kp = 3."
)


def figure_2_8() -> Entry:
    """The thesis's conclusion, and its limits."""
    cases = list(study(LOOPS, DESIGN))
    amplitude = 3.0
    closed = complex(play_describing_function(np.array([amplitude]), DESIGN.deadband, DESIGN.compliance)[0])
    sampled = play_numerically(amplitude, DESIGN.deadband, DESIGN.compliance)
    return Entry(
        "2-8",
        "Figure 2-8: Nyquist curve and describing function",
        "The first-order curve stays in the right half plane and never meets -1 / N(A): no limit cycle. Higher-order "
        "terms might change that.",
        FOUND,
        (
            Number("limit cycles of the thesis's loop", 0.0, float(len(predict(thesis_loop(), DESIGN))), "", 0),
            Number(
                "N(A) at 3 psi, closed form against sampled",
                None,
                abs(closed - sampled) / abs(closed) * 100.0,
                "% off",
                4,
            ),
            *(number for case in cases for number in _numbers(case)),
            *(number for loop in WIRED_LOOPS for number in _wired(loop)),
            *(number for dead_s in DEAD_TIMES_S for number in _borders(dead_s)),
        ),
        _draw,
        size_in=(7.2, 8.0),
        command="lostmotion analyse --law p_incremental --kp 3 --modbus",
        notes=(
            DELAY,
            f"{CONDITIONS}. {WIRED}; there only what the stops permit is left of the largest oscillations.",
            "`lostmotion analyse` makes the first table; `lostmotion analyse --law p_incremental --sweep kp=2:6:9 "
            "--dead-time 0.5 --csv FILE.csv --plot FILE.png` makes a sweep as in the lower panels.",
        ),
    )


def _draw(canvas: Canvas) -> None:
    (left, right), (swing, period) = canvas.subplots(2, 2, height_ratios=(1.6, 1.0))
    nyquist(left, [thesis_loop()], DESIGN)
    nyquist(right, [INCREMENTAL, replace(INCREMENTAL, dead_time_s=1.0), LinearLoop("pi", 3.0, 8.0)], DESIGN)
    left.set_title("as in the thesis", fontsize=9)
    right.set_title("with lag, delay and sampling", fontsize=9)
    for dead_s, colour in ((0.0, BLUE), (0.5, ORANGE)):
        cases = list(study([replace(INCREMENTAL, kp=kp, dead_time_s=dead_s) for kp in SWEPT], DESIGN))
        curves(swing, period, cases, DESIGN.travel, SWEPT, colour, f", dead time {dead_s:g} s")
    swing.legend(frameon=False, fontsize=6)
    for axes in (swing, period):
        axes.set_xlabel("Kp of the incremental law [psi/in]")


def _numbers(case: Case) -> list[Number]:
    balanced = case.balanced[0] if case.balanced else None
    found = (
        ("describing function", case.predicted, "none"),
        ("harmonic balance", balanced, "not found"),
        ("measured", case.measured, "none"),
    )
    numbers = []
    for how, cycle, absent in found:
        swing = 200.0 * cycle.stem_in / DESIGN.travel if cycle else math.nan
        period_s = cycle.period_s if cycle else math.nan
        numbers.append(Number(f"{name(case.loop)}: swing, {how}", None, swing, "% of travel", 1, absent))
        numbers.append(Number(f"{name(case.loop)}: period, {how}", None, period_s, "s", 1, ""))
    return numbers


def name(loop: LinearLoop) -> str:
    """The loop as the tables call it."""
    return f"{loop.law} Kp {loop.kp:g}" + (f" Ki {loop.ki:g}" if loop.law == "pi" else "")


def _wired(loop: LinearLoop) -> list[Number]:
    found = measure_wired(loop, DESIGN)
    swing = 200.0 * found.stem_in / DESIGN.travel if found else math.nan
    label = f"{name(loop)}, real stops over Modbus"
    return [
        Number(f"{label}: swing", None, swing, "% of travel", 1, "none"),
        Number(f"{label}: period", None, found.period_s if found else math.nan, "s", 1, ""),
    ]


def _borders(dead_s: float) -> list[Number]:
    """The lowest gains that hunt with this dead time, by describing function and measured (from 0.75 of that on)."""
    numbers = []
    for law, gains in GAINS.items():
        make = partial(_incremental if law == "incremental Kp" else _pi, dead_s)
        first = first_gain(partial(_predicted, make), gains)
        on_valve = first_gain(partial(_measured, make), [gain for gain in gains if gain >= 0.75 * first])
        unit = "psi/in" if law == "incremental Kp" else "psi/(in s)"
        numbers.append(Number(f"dead time {dead_s:g} s: {law}, describing function", None, first, unit, 1))
        numbers.append(Number(f"dead time {dead_s:g} s: {law}, measured", None, on_valve, unit, 1))
    return numbers


def _predicted(make: Callable[[float], LinearLoop], gain: float) -> bool:
    return any(cycle.stable for cycle in predict(make(gain), DESIGN, n=60, points=300))


def _measured(make: Callable[[float], LinearLoop], gain: float) -> bool:
    return measured(make(gain), DESIGN) is not None


def _incremental(dead_s: float, kp: float) -> LinearLoop:
    return replace(INCREMENTAL, kp=kp, dead_time_s=dead_s)


def _pi(dead_s: float, ki: float) -> LinearLoop:
    return LinearLoop("pi", 3.0, ki, dead_time_s=dead_s)
