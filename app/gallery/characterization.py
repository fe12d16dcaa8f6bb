"""Chapter 1: the original positioner, steps through the converter, the backlash curves with table 2-1."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from app.gallery.figure import BLUE, GREY, ORANGE, RED, Entry, Number
from app.gallery.record import IDENTIFY, STAIRCASE, Sweep, identified, settled
from control.characterize import Settling, characterize
from control.design import DesignModel
from logs.recording import FloatArray
from sim_device.physics.positioner.plant import Pilot

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

DESIGN = DesignModel()
TARGETS = (0.0, 25.0, 50.0, 75.0, 100.0, 75.0, 50.0, 25.0)
POSITIONER_HOLD_S = 120.0
POSITIONER = Sweep("points", {"points": [[target, 0.0, POSITIONER_HOLD_S] for target in TARGETS]}, physics="positioner")
ENOUGH_PSI = 13.0
STEP_PSI, STEP_HOLD_S = 0.25, 20.0
STEPS = Sweep("staircase", {"low": 5.0, "high": 12.0, "step": STEP_PSI, "dwell_s": STEP_HOLD_S})
MOVED = 0.02  # of travel: the stem has followed


def figure_1_2() -> Entry:
    """The original positioner hunts."""
    targets = np.array(TARGETS)
    run = POSITIONER.record()
    percent = 100.0 * run.position / DESIGN.travel
    n = round(POSITIONER_HOLD_S * 10)
    tails = percent.reshape(-1, n)[:, n // 2 :]
    error = np.abs(tails.mean(axis=1) - targets)
    swing = np.percentile(tails, 99, axis=1) - np.percentile(tails, 1, axis=1)
    pilot = Pilot()
    reach = 100.0 * DESIGN.compliance * (pilot.supply - DESIGN.a1) / DESIGN.travel

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.plot(run.time_s, run.command, color=GREY, lw=1, label="command")
        axes.plot(run.time_s, percent, color=BLUE, lw=0.8, label="stem")
        axes.set(xlabel="time [s]", ylabel="position [% of travel]")
        axes.legend(loc="upper left", frameon=False)

    return Entry(
        "1-2",
        "Figure 1-2: step response with the original positioner",
        "The valve closes only to 97 %, the steady error reaches 5 % of travel, and the actuator hunts.",
        f"All three come out of one mechanism. The pilot's air supply, {pilot.supply:g} psi, ends where the closing "
        f"curve has reached {reach:.1f} %; the feedback lever turns, so its arc is not the stem's line; and its relay "
        f"has to carry the pressure across a deadband of {DESIGN.deadband:.2f} psi every time the sign of the error "
        "changes, while the stem moves on. The positioner's numbers are ours, for the thesis gives none: the supply "
        f"was chosen so that it comes to 97 % (with {ENOUGH_PSI:g} psi, `--plant supply={ENOUGH_PSI:g}`, the valve "
        f"closes to {_closed():.0f} %), and the lever's angle so that the error comes near 5 %. What emerges is that "
        "all three appear together, where, and that the stem hunts although no line of the program makes it.",
        (
            Number("highest position", 97.0, float(tails[targets == 100.0].mean()), "%", 1),
            Number("largest mean error of a hold below 100 %", 5.0, float(error[targets < 100.0].max()), "%", 1),
            Number("mean error at 100 %, for want of air", 3.0, float(error[targets == 100.0].max()), "%", 1),
            Number("largest hunting, peak to peak", None, float(swing.max()), "%", 1),
        ),
        draw,
        command=POSITIONER.command(),
    )


def _closed() -> float:
    """Where the valve comes at a command of 100 % when the pilot has air enough [%]."""
    rows = replace(POSITIONER, plant={"supply": ENOUGH_PSI}).record().position.reshape(len(TARGETS), -1)
    return 100.0 * float(np.median(rows[TARGETS.index(100.0), rows.shape[1] // 2 :])) / DESIGN.travel


def figure_1_5() -> Entry:
    """The converter moves it smoothly, and lays the backlash bare."""
    run = STEPS.record()
    percent = 100.0 * run.position / DESIGN.travel
    commands, rests = settled(run, STEP_HOLD_S, percent)
    fall_psi = _stillness(commands, rests)

    def draw(canvas: Canvas) -> None:
        upper = canvas.subplots()
        upper.plot(run.time_s, percent, color=BLUE, lw=1)
        upper.set(xlabel="time [s]", ylabel="position [% of travel]")
        lower = upper.twinx()
        lower.plot(run.time_s, run.command, color=ORANGE, lw=0.8)
        lower.set_ylabel("pressure command [psi]", color=ORANGE)

    return Entry(
        "1-5",
        "Figure 1-5: steps of pressure through the E/P converter",
        "No hunting, the full range of motion; but while the pressure turns round, many small steps move nothing.",
        "The same on the virtual valve: it reaches both stops, and at the turn the pressure falls by about the "
        f"deadband before the stem follows. In steps of {STEP_PSI:g} psi, and with {100.0 * MOVED:g} % of travel as "
        "the sign that it has followed, that fall is known to a step; figure 1-6 has it precisely.",
        (
            Number("lowest position at rest", 0.0, float(rests.min()), "%", 1),
            Number("highest position at rest", 100.0, float(rests.max()), "%", 1),
            Number("fall at the turn, at the last step that moves nothing", None, fall_psi - STEP_PSI, "psi", 2),
            Number("fall at the turn, at the first step that moves the stem", 2.96, fall_psi, "psi", 2),
        ),
        draw,
        command=STEPS.command(),
    )


def _stillness(commands: FloatArray, rests: FloatArray) -> float:
    """How far the command falls from the lowest with which the stop is reached until the stem has left it [psi]."""
    top = float(rests.max()) - 100.0 * MOVED
    reached = int(np.argmax(rests > top))
    left = reached + int(np.argmax(rests[reached:] < top))
    return float(commands[reached] - commands[left])


def figure_1_6() -> Entry:
    """The two curves, and table 2-1."""
    run, found = STAIRCASE.record(), identified()
    curves = characterize([run], Settling(found.design.tau_s, found.design.ep_tau_s, found.design.rate_limit))
    assert curves.closing is not None and curves.opening is not None
    closing, opening = curves.closing, curves.opening

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        for curve, colour, name in ((closing, BLUE, "closing"), (opening, RED, "opening")):
            onset, slope = curve.onset.value, curve.compliance.value
            axes.plot(curve.pressure, curve.position, ".", color=colour, ms=4, label=f"{name}, at rest")
            line = np.array([onset, onset + DESIGN.travel / slope])
            axes.plot(line, slope * (line - onset), color=colour, lw=0.8)
        axes.set(xlabel="pressure [psi]", ylabel="position at rest [in]")
        axes.legend(frameon=False)

    return Entry(
        "1-6",
        "Figure 1-6 and table 2-1: the backlash curves and the numbers",
        "Two straight curves; k_eq is the mean of their slopes.",
        "What `lostmotion identify` makes of one staircase: robust lines through the dwells (the picture, and the rows "
        "`curves`), and a fit of the whole valve. With half the width of the 95 % intervals.",
        _table_2_1(),
        draw,
        command=IDENTIFY,
    )


def _table_2_1() -> tuple[Number, ...]:
    rows = (
        ("a1", 8.78, 3), ("a2", 5.82, 3), ("deadband", 2.96, 3), ("k1", None, 4), ("k2", None, 4), ("k_eq", 0.19, 4),
        ("a1 (curves)", 8.78, 3), ("a2 (curves)", 5.82, 3), ("k1 (curves)", None, 4), ("k2 (curves)", None, 4),
        ("travel", 0.5625, 4), ("tau", None, 3), ("tau (63 %)", 2.7, 3), ("rate_limit", None, 4), ("ep.tau", None, 3),
    )  # fmt: skip
    numbers = []
    for name, thesis, digits in rows:
        each = identified()[name]
        numbers.append(Number(f"{name}: value", thesis, each.value, each.unit, digits))
        if each.interval is not None:
            numbers.append(Number(f"{name}: +-", None, each.interval.half_width, each.unit, digits + 1))
    return tuple(numbers)
