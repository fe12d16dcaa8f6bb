"""P and PI control, and our best, on the bench of chapter 3."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from app.gallery.bench import DESIGN, PERIOD_S, Case, first_move, response, stem, swing, tails
from app.gallery.figure import Entry, Number
from control.analysis.measured import measure_cycle
from control.trial import Trace
from sim_device.physics.plant_chapter3 import HELD_PSI

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

KP = 3.0
GAINS = (1.0, 2.0, KP, 4.0)
LONG_S, WINDOW_S = 300.0, 60.0
UP_AND_DOWN = (25.0, 50.0, 75.0, 50.0, 25.0)
BENCHES = {"chapter3": "the bench of chapter 3", "thesis": "valve as designed"}
LEAST_SWING = 0.01  # of travel: less is no limit cycle here

READINGS = (
    "The thesis does not give the unit of Kp; in psi/in both readings of figure 3-1 are built. The positional one (a "
    f"fixed bias plus Kp e) moves the pressure by {KP * DESIGN.travel:.1f} psi over the whole range of errors, less "
    "than the deadband: very large errors, no fluctuation. The incremental one adds Kp e to the measured pressure, so "
    "it integrates."
)
LOST = (
    f"There the converter stops {HELD_PSI:g} psi above its set point when it lets air out, and the law starts from the "
    "measured pressure, so that every such step loses that much; a correction that asks for less does nothing at all, "
    f"and the loop can rest up to {HELD_PSI:g} psi / Kp = {100.0 * HELD_PSI / KP / DESIGN.travel:.1f} % of travel "
    "beside the target."
)


def _windows(trace: Trace, hold_s: float) -> tuple[float, float, int, float]:
    """The largest swing in the second and in the last minute of the holds [%], how many holds cycle on to their end,
    and the largest mean error of a last minute [%].
    """
    rows, window = round(hold_s / trace.period_s), round(WINDOW_S / trace.period_s)
    error = 100.0 * (trace.truth_in - trace.target_in).reshape(-1, rows) / DESIGN.travel
    time_s = trace.time_s[:rows]
    cycles = sum(measure_cycle(time_s, hold, 100.0 * LEAST_SWING / 2.0) is not None for hold in error)
    early, late = error[:, window : 2 * window], error[:, -window:]
    steady = float(np.abs(late.mean(axis=1)).max())
    return float(np.ptp(early, axis=1).max()), float(np.ptp(late, axis=1).max()), cycles, steady


def figure_3_2() -> Entry:
    """P control, both readings."""
    cases = {(kp, bench): _incremental(kp, bench) for kp in GAINS for bench in BENCHES}
    traces = {key: case.trial() for key, case in cases.items()}
    seen = {key: _windows(trace, LONG_S) for key, trace in traces.items()}
    positional = np.abs(Case("p", {"kp": KP}).tails().mean(axis=1))
    rung, designed = seen[KP, "chapter3"], seen[KP, "thesis"]

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots(2, 1, sharex=True)
        for panel, (bench, name) in zip(axes, BENCHES.items(), strict=True):
            stem(traces[KP, bench], panel)
            panel.set_title(f"p_incremental, Kp = {KP:g} psi/in, {name}", fontsize=9)
        axes[1].set_xlabel("time [s]")

    return Entry(
        "3-2",
        "Figure 3-2: P control, Kp = 3",
        "Very large steady errors, fluctuations of more than 10 % of travel; changing Kp has little effect.",
        f"{READINGS} On a valve as designed it hunts for good, as item 2-8 predicts: {designed[1]:.0f} % in the last "
        f"minute of holds of {LONG_S:.0f} s. On the bench of chapter 3 it only rings: {rung[0]:.0f} % in the second "
        f"minute, {rung[1]:.1f} % in the last. {LOST}",
        (
            Number("largest steady error, positional", None, float(positional.max()), "% of travel", 0),
            *(number for (kp, bench), found in seen.items() for number in _row(f"Kp {kp:g}, {BENCHES[bench]}", found)),
        ),
        draw,
        (7.2, 4.2),
        command=cases[KP, "chapter3"].command(),
        notes=(
            "Not reproduced: very large errors and fluctuations of more than 10 % in one response, and that Kp has "
            "little effect. Here the errors belong to the positional reading or a small Kp, the fluctuations to the "
            f"incremental one, and Kp decides. In a record of a minute or two a step the ringing at Kp = {KP:g} may "
            "look like the thesis's words.",
        ),
    )


def _incremental(kp: float, bench: str) -> Case:
    return Case("p_incremental", {"kp": kp}, UP_AND_DOWN, LONG_S, bench)


def _row(name: str, found: tuple[float, float, int, float]) -> list[Number]:
    early, late, cycles, steady = found
    return [
        Number(f"{name}: swing, second minute", None, early, "% of travel", 1),
        Number(f"{name}: swing, last minute", None, late, "% of travel", 1),
        Number(f"{name}: holds of {len(UP_AND_DOWN)} that cycle to the end", None, float(cycles), "", 0),
        Number(f"{name}: largest steady error", None, steady, "% of travel", 1),
    ]


def figure_3_4() -> Entry:
    """PI control."""
    cases = {ki: Case("pi_antiwindup", {"ki": ki}, hold_s=2.0 * LONG_S / 3.0) for ki in (8.0, 1.0)}
    traces = {ki: case.trial() for ki, case in cases.items()}
    hunting, quiet = (swing(tails(traces[ki], cases[ki].hold_s)) for ki in (8.0, 1.0))
    away = {"steps": (100.0, 100.0, 40.0), "hold_s": 60.0}
    wound, kept = (Case(name, {"max_psi": 11.0}, **away).trial() for name in ("pi", "pi_antiwindup"))  # type: ignore[arg-type]
    slow = first_move(traces[1.0], round(4 * cases[1.0].hold_s / PERIOD_S))
    late = first_move(wound, 1200) - first_move(kept, 1200)
    return Entry(
        "3-4",
        "Figure 3-4: PI control",
        "Windup at once, so anti-windup was added; large fluctuations and steady errors remained.",
        "The thesis does not give Ki. "
        "With Ki = 8 psi/(in s) the loop lies beyond the border of item 2-8 and hunts. With Ki = 1 it does not hunt, "
        f"but {slow / 10.0:.0f} s pass in the deadband at the turn from 100 % to 75 %. Without anti-windup and with "
        "only 11 psi of supply, the way back from a target out of reach starts later.",
        (
            Number("fluctuation in the last minute, Ki = 8", None, hunting, "% of travel", 0),
            Number("fluctuation in the last minute, Ki = 1", None, quiet, "% of travel", 1),
            Number("windup costs", None, late / 10.0, "s", 1),
        ),
        lambda canvas: response(traces[8.0], canvas),
        command=cases[8.0].command(),
    )


def figure_beyond() -> Entry:
    """Our best on the same bench."""
    case = Case("brake")
    trace = case.trial()
    tail = tails(trace)
    return Entry(
        "beyond",
        "Beyond: the same steps on the same imperfect bench with `brake`",
        "",
        "A filter through the play learns both edges, the compliance and how sure of them it is, from the measured "
        "pressure and position; the converter's calibration, hysteresis and dead time besides. Moves run at the rate "
        "limit and brake on the opposite edge; then the pressure backs off, and the play holds the stem.",
        (
            Number("largest steady error", 1.3, float(np.abs(tail.mean(axis=1)).max()), "% of travel", 2),
            Number("largest momentary error", None, float(np.abs(tail).max()), "% of travel", 2),
        ),
        lambda canvas: response(trace, canvas),
        command=case.command(),
    )
