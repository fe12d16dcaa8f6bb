"""If-Then control on the bench of chapter 3: bounces, the error that stays when opening, and what PI makes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from app.gallery.bench import DESIGN, HOLD_S, STEPS, TOLERANCE_IN, Case, response, swing, tails
from app.gallery.figure import Entry, Number
from logs.recording import FloatArray
from sim_device.physics.plant_chapter3 import COMPLIANCE, HELD_PSI

SEEDS = range(8)
FEW_SEEDS = range(5)
SETTLED_S, LONG_S = 150.0, 600.0
THRESHOLD_PSI, PACE_S, PATIENT_S = 8.12, 9.0, 15.0
SCAN = range(50, 86, 2)  # percent of travel
CHOSEN = (
    f"Chosen by us, for the thesis gives none of them: the pace of the loop, the error left alone ({TOLERANCE_IN} in, "
    "three standard deviations of a reading), how long a target is held, and what is wrong with the bench."
)
REMAINDER = (
    "The rule adds g e to the *measured* pressure. The converter fills to its set point exactly, but when it lets "
    f"air out it stops {HELD_PSI:g} psi above it (a relieving regulator's hysteresis, calibrated away for filling). "
    f"The rule comes to rest when g e equals that remainder: {HELD_PSI:g} psi x {DESIGN.compliance:g} in/psi = "
    f"{100.0 * HELD_PSI * DESIGN.compliance / DESIGN.travel:.1f} % of travel at most, and only after a release. "
    "Closing moves cannot leave such an error, as long as they do not overshoot: the springs are "
    f"{100.0 * (1.0 - COMPLIANCE / DESIGN.compliance):.0f} % stiffer than the g of the rule supposes, so it comes "
    f"from below, and it looks again only after {PATIENT_S:g} s, when "
    f"{100.0 * np.exp(-PATIENT_S / DESIGN.tau_s):.1f} % of the last move is still to come. It leaves alone what is "
    f"smaller than three standard deviations of a reading ({TOLERANCE_IN} in); without that, noise would send it "
    "across the deadband and back."
)
SUPPOSED = (
    "The size of the hysteresis was chosen so that the opening error comes near 2.2 %; what emerges is that it "
    "is there, and on which side. Every 9 s and without the tolerance the rule overshoots, corrects backwards "
    "and is caught by the same remainder, so that closing moves end with an error too. The thesis gives "
    "neither the pace of its loop nor a tolerance; this is a way in which its finding can have come about, "
    "not a proof that it has."
)
CONSTANT = Case("if_then_constant", {"threshold_psi": THRESHOLD_PSI, "update_s": PACE_S, "tolerance_in": TOLERANCE_IN})
LINE = Case("if_then_line", {"update_s": PATIENT_S, "tolerance_in": TOLERANCE_IN}, hold_s=SETTLED_S)
WITH_PI = Case("if_then_pi", {"ki": 0.15, "window_in": 0.03, "update_s": PACE_S, "tolerance_in": TOLERANCE_IN})


def figure_3_7() -> Entry:
    """The constant threshold bounces."""
    trace = CONSTANT.trial()
    tail = tails(trace)
    swings, means = np.ptp(tail, axis=1), tail.mean(axis=1)
    crosses = 100.0 * COMPLIANCE * (THRESHOLD_PSI - DESIGN.a2) / DESIGN.travel
    bounces = _first_bounce()
    remainder = 100.0 * HELD_PSI * COMPLIANCE / DESIGN.travel
    ideal = replace(CONSTANT, physics="thesis").tails()
    eager = replace(CONSTANT, settings={**CONSTANT.settings, "tolerance_in": 0.0}).tails()
    return Entry(
        "3-7",
        "Figure 3-7: If-Then control, threshold 8.12 psi",
        "At 0 % and 100 % the steady error is gone; the positions are stable except for bounces.",
        f"Above {crosses:.0f} % of travel even the opening curve of this bench lies above {THRESHOLD_PSI} psi. A stem "
        "that rests there, a little too far closed and with its pressure already on the opening curve, looks to the "
        "rule like one on the closing curve: it takes off another deadband, and the valve falls open; then it closes "
        f"again. Returns from 100 % bounce from {bounces} % on, earlier than {crosses:.0f} %, because they end too far "
        f"closed, by what the converter holds back ({HELD_PSI:g} psi, {remainder:.1f} % of travel, and less once the "
        "rule has looked again). Below, the threshold is between the curves, and no hold ends with a swing. At 100 % "
        "the stem rests on its stop and reads no error.",
        (
            *(number for name, row in _holds(swings, means).items() for number in _pair(name, row)),
            Number("the opening curve passes the threshold at", None, crosses, "% of travel", 0),
            Number("returns from 100 % bounce from", None, float(bounces), "% of travel", 0),
            Number("largest swing, valve as designed", None, swing(ideal), "% of travel", 1),
        ),
        lambda canvas: response(trace, canvas),
        command=CONSTANT.command(),
        notes=(
            f"Reproduced: bounces, and no error at 100 % ({abs(means[3]):.1f} %). Not reproduced: that it is gone at "
            f"0 %; ours is {means[-1]:+.1f} %, the converter's remainder as in figure 3-10. Without the tolerance the "
            f"rule bounces at 100 % too, by {np.ptp(eager[3]):.0f} %.",
            CHOSEN,
        ),
    )


def _holds(swings: FloatArray, means: FloatArray) -> Mapping[str, tuple[float, float]]:
    ways = ["closing" if step > before else "opening" for before, step in zip((0.0, *STEPS), STEPS, strict=False)]
    return {
        f"{step:g} %, {way}": (float(mean), float(size))
        for step, way, mean, size in zip(STEPS, ways, means, swings, strict=True)
    }


def _pair(name: str, row: tuple[float, float]) -> tuple[Number, Number]:
    return (
        Number(f"{name}: mean error", None, row[0], "% of travel", 1),
        Number(f"{name}: swing", None, row[1], "% of travel", 1),
    )


def _first_bounce() -> int:
    """The lowest position of the scan at which a return from 100 % ends in a bounce [%]."""
    for position in SCAN:
        tail = replace(CONSTANT, steps=(100.0, float(position))).tails()
        if np.ptp(tail[-1]) > 5.0:
            return position
    return SCAN.stop


def figure_3_10() -> Entry:
    """The threshold line: an error only when opening."""
    trace = LINE.trial()
    tail = tails(trace, SETTLED_S)
    closing, opening = _worst(tail)
    others = [_worst(LINE.tails(seed)) for seed in SEEDS]
    held = replace(LINE, hold_s=LONG_S).tails()
    hasty = [_worst(Case("if_then_line", {"update_s": PACE_S, "tolerance_in": 0.0}).tails(seed)) for seed in SEEDS]
    ideal = _worst(replace(LINE, physics="thesis").tails())
    return Entry(
        "3-10",
        "Figure 3-10: If-Then control with the threshold line",
        "No bounces; the largest steady error is 2.2 %, and only when the pressure is released and the valve opens.",
        REMAINDER,
        (
            Number("largest error, opening", 2.2, opening, "% of travel", 1),
            Number("largest error, closing", 0.0, closing, "% of travel", 1),
            Number("largest swing of a hold", 0.0, float(np.ptp(tail, axis=1).max()), "% of travel", 1),
            Number("median over 8 seeds, opening", None, float(np.median([o for _, o in others])), "% of travel", 1),
            Number("median over 8 seeds, closing", None, float(np.median([c for c, _ in others])), "% of travel", 1),
            Number("worst of 8 seeds, opening", None, max(o for _, o in others), "% of travel", 1),
            Number("worst of 8 seeds, closing", None, max(c for c, _ in others), "% of travel", 1),
            Number(f"held for {LONG_S:g} s, opening", None, _worst(held)[1], "% of travel", 1),
            Number(f"held for {LONG_S:g} s, closing", None, _worst(held)[0], "% of travel", 1),
            Number(f"held for {LONG_S:g} s, swing", None, swing(held), "% of travel", 1),
            Number("worst of 8 seeds, closing, every 9 s", None, max(c for c, _ in hasty), "% of travel", 1),
            Number("largest error, valve as designed", None, max(ideal), "% of travel", 1),
        ),
        lambda canvas: response(trace, canvas),
        command=LINE.command(),
        notes=(SUPPOSED,),
    )


def _worst(tail: FloatArray) -> tuple[float, float]:
    """The largest steady error of the closing and of the opening moves [% of travel]."""
    error = np.abs(tail.mean(axis=1))
    return float(error[:4].max()), float(error[4:].max())


def figure_3_12() -> Entry:
    """If-Then with PI."""
    trace = WITH_PI.trial()
    holds = {HOLD_S: SEEDS, 4.0 * HOLD_S: FEW_SEEDS}
    found = {
        (hold_s, tolerance_in): _errors(hold_s, tolerance_in, seeds)
        for tolerance_in in (TOLERANCE_IN, 0.0)
        for hold_s, seeds in holds.items()
    }
    short, long = found[HOLD_S, TOLERANCE_IN], found[4.0 * HOLD_S, TOLERANCE_IN]
    cycling = found[4.0 * HOLD_S, 0.0]
    return Entry(
        "3-12",
        "Figure 3-12: If-Then control with PI and anti-windup",
        "Steady error down to 1.3 % of travel, no fluctuations, 100 % of travel is reached.",
        "The same bench. The integral learns the remainder of the relieving converter, and has to unlearn it whenever "
        f"the direction changes. That takes minutes: when a hold ends after {HOLD_S:g} s, what is left is about the "
        f"thesis's 1.3 % (median {np.median(short[0]):.1f} %, worst {max(short[0]):.1f} % over {len(short[0])} seeds); "
        f"after {4.0 * HOLD_S:g} s it is {np.median(long[0]):.1f} % ({max(long[0]):.1f} %), and the stem is still "
        f"(swing {np.median(long[1]):.1f} %, worst {max(long[1]):.1f} %). So our 1.3 % is what the hold is too short "
        "for, and no property of the law. Without the tolerance the rule never stops correcting what it cannot see: a "
        f"slow limit cycle of {min(cycling[1]):.1f} to {max(cycling[1]):.1f} % stays in holds of {4.0 * HOLD_S:g} s.",
        (
            Number("largest steady error", 1.3, max(_worst(tails(trace))), "% of travel", 1),
            Number("largest position", 100.0, 100.0 * float(trace.truth_in.max()) / DESIGN.travel, "%", 1),
            *(number for (hold_s, tol), values in found.items() for number in _cells(hold_s, tol, values)),
        ),
        lambda canvas: response(trace, canvas),
        command=WITH_PI.command(),
        notes=(CHOSEN, "Chosen as well: ki = 0.15 psi/(in s), and that it acts on errors of up to 0.03 in only."),
    )


def _errors(hold_s: float, tolerance_in: float, seeds: Sequence[int]) -> tuple[list[float], list[float]]:
    """Of every seed, the largest steady error of a hold and the largest swing of an inner one [% of travel]."""
    case = replace(WITH_PI, hold_s=hold_s, settings={**WITH_PI.settings, "tolerance_in": tolerance_in})
    all_tails = [case.tails(seed) for seed in seeds]
    return [max(_worst(tail)) for tail in all_tails], [swing(tail) for tail in all_tails]


def _cells(hold_s: float, tolerance_in: float, values: tuple[list[float], list[float]]) -> list[Number]:
    alone = f"errors below {tolerance_in:g} in left alone" if tolerance_in else "no tolerance"
    name = f"held for {hold_s:g} s, {alone}"
    columns = ("steady error, median of seeds", "steady error, worst", "swing, median of seeds", "swing, worst")
    sizes = [pick(each) for each in values for pick in (np.median, max)]
    return [
        Number(f"{name}: {column}", None, float(size), "% of travel", 1)
        for column, size in zip(columns, sizes, strict=True)
    ]
