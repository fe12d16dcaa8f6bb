"""Chapter 1 and sections 2.1 and 2.2: positioner, converter, backlash curves, steady and transient model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from app.gallery.figure import BLUE, GREY, ORANGE, RED, Entry, Number
from app.gallery.record import fit_percent, levels, play, settled, simulated
from control.characterize import Settling, characterize
from control.design import DesignModel
from logs.recording import FloatArray, Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

DESIGN = DesignModel()
SERIES = (0, 9.5, 10.5, 11.5, 10.5, 9.5, 8.5, 7.5, 8.5, 9.5, 10.5, 12.0, 11.0, 9.0, 7.0, 5.0, 4.0)


def figure_1_2() -> Entry:
    """The original positioner hunts."""
    targets = np.array([0.0, 25.0, 50.0, 75.0, 100.0, 75.0, 50.0, 25.0])
    hold_s = 120.0
    run = play(levels(list(targets), hold_s), "positioner")
    percent = 100.0 * run.position / DESIGN.travel
    n = round(hold_s * 10)
    tails = percent.reshape(-1, n)[:, n // 2 :]
    error = np.abs(tails.mean(axis=1) - targets)
    error[targets == 100.0] = 0.0
    swing = np.percentile(tails, 99, axis=1) - np.percentile(tails, 1, axis=1)

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
        "All three come out of one mechanism that nobody scripted: the pilot's supply ends where the closing curve has "
        "reached about 97 %; the feedback lever turns, so its arc is not the stem's line; and its relay has to carry "
        "the pressure across a deadband of 2.96 psi every time the sign of the error changes, while the stem moves on.",
        (
            Number("highest position", 97.0, float(tails[targets == 100.0].mean()), "%", 1),
            Number("largest mean error of a hold", 5.0, float(error.max()), "%", 1),
            Number("largest hunting, peak to peak", None, float(swing.max()), "%", 1),
        ),
        draw,
        command="lostmotion sweep staircase --profile positioner --physics positioner",
    )


def figure_1_5() -> Entry:
    """The converter moves it smoothly, and lays the backlash bare."""
    closing, opening = np.arange(7.5, 12.3, 0.25), np.arange(11.9, 4.9, -0.25)
    run = play(levels([5.0, *closing, *opening], 20.0))
    percent = 100.0 * run.position / DESIGN.travel
    still = _stillness(run)

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
        "deadband before the stem follows.",
        (
            Number("lowest position", 0.0, float(percent[-150:].mean()), "%", 1),
            Number("highest position", 100.0, float(np.percentile(percent, 99.5)), "%", 1),
            Number("pressure fall at the turn before the stem follows", 2.96, still, "psi", 2),
        ),
        draw,
        command="lostmotion sweep staircase",
    )


def _stillness(run: Recording) -> float:
    """How far the command falls from where the curve was left until the stem has moved by 1 % [psi]."""
    top = float(np.percentile(run.position, 99.5))
    leaves = int(np.argmax(run.position > top - 0.02 * DESIGN.travel))
    falls = run.time_s > run.time_s[int(np.argmax(run.command))]
    moved = int(np.argmax(falls & (run.position < top - 0.02 * DESIGN.travel)))
    return float(run.command[leaves] - run.command[moved])


def figure_1_6() -> Entry:
    """The two curves, and table 2-1."""
    run = _sweep()
    curves = characterize([run], Settling(DESIGN.tau_s, DESIGN.ep_tau_s, DESIGN.rate_limit))
    assert curves.closing is not None and curves.opening is not None
    closing, opening = curves.closing, curves.opening
    a1, a2 = closing.onset.value, opening.onset.value
    k1, k2 = closing.compliance.value, opening.compliance.value

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        for curve, onset, slope, colour, name in (
            (closing, a1, k1, BLUE, "closing"),
            (opening, a2, k2, RED, "opening"),
        ):
            axes.plot(curve.pressure, curve.position, ".", color=colour, ms=4, label=f"{name}, at rest")
            line = np.array([onset, onset + DESIGN.travel / slope])
            axes.plot(line, slope * (line - onset), color=colour, lw=0.8)
        axes.set(xlabel="pressure [psi]", ylabel="position at rest [in]")
        axes.legend(frameon=False)

    return Entry(
        "1-6",
        "Figure 1-6 and table 2-1: the backlash curves and the numbers",
        "Two straight curves; k_eq is the mean of their slopes.",
        "Robust lines through the dwells of one sweep. `lostmotion identify` gives the same with intervals, and the "
        "time constants and the rate limit besides.",
        (
            Number("a1", 8.78, a1, "psi", 2),
            Number("a2", 5.82, a2, "psi", 2),
            Number("deadband width", 2.96, a1 - a2, "psi", 2),
            Number("k1, closing", None, k1, "in/psi", 4),
            Number("k2, opening", None, k2, "in/psi", 4),
            Number("k_eq", 0.19, 0.5 * (k1 + k2), "in/psi", 4),
        ),
        draw,
        command="lostmotion sweep staircase --out RUN && lostmotion identify RUN --out MODEL.toml",
    )


def _sweep() -> Recording:
    up, down = np.arange(8.0, 12.1, 0.2), np.arange(12.1, 5.2, -0.2)
    return play(levels([5.0, *up, *down, *up, *down], 25.0))


def figure_2_4() -> Entry:
    """Steady positions for a random series of steps."""
    chance = np.random.default_rng(24)
    commands = chance.uniform(5.5, 12.0, 40)
    run = play(levels(list(commands), 25.0))
    at, measured = settled(run, 25.0)
    model = _static(at)

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.plot(at, measured, "o", color=BLUE, ms=5, mfc="none", label="virtual valve, settled")
        axes.plot(at, model, "x", color=RED, ms=5, label="model: play and slope")
        axes.set(xlabel="pressure command [psi]", ylabel="position [in]")
        axes.legend(frameon=False)

    error = 100.0 * np.abs(measured - model) / DESIGN.travel
    return Entry(
        "2-4",
        "Figure 2-4: steady state, model and record",
        "Excellent agreement (no number).",
        "A random series of steps; every settled position against the play alone.",
        (
            Number("fit", None, fit_percent(measured, model), "%", 2),
            Number("largest difference", None, float(error.max()), "% of travel", 2),
        ),
        draw,
    )


def _static(commands: FloatArray) -> FloatArray:
    w, out = 0.0, []
    for p in commands:
        w = min(
            max(DESIGN.compliance * (p - DESIGN.a1), min(DESIGN.compliance * (p - DESIGN.a2), w), 0.0), DESIGN.travel
        )
        out.append(w)
    return np.array(out)


def figure_2_5() -> Entry:
    """A step of 0.25 psi and the 63 % rule."""
    run = play(np.concatenate([levels([5.0, 10.0], 40.0), levels([10.25], 25.0)]), seed=2)
    start = round(80.0 * 10)
    t, x = run.time_s[start:] - run.time_s[start], run.position[start:]
    first, last = float(run.position[start - 100 : start].mean()), float(x[-80:].mean())
    smooth = np.convolve(x, np.ones(5) / 5.0, "same")
    rise_s = float(t[int(np.argmax(smooth >= first + 0.632 * (last - first)))])
    model = simulated(run, DESIGN)[start:]

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.plot(t, x, color=BLUE, lw=0.8, label="virtual valve")
        axes.plot(t, model, color=RED, lw=1, label="model")
        axes.axhline(first + 0.632 * (last - first), color=GREY, lw=0.6, ls="--")
        axes.axvline(rise_s, color=GREY, lw=0.6, ls="--")
        axes.set(xlabel="time since the step [s]", ylabel="position [in]")
        axes.legend(frameon=False)

    return Entry(
        "2-5",
        "Figure 2-5: response to a step of 0.25 psi",
        "By the 63 % rule the time constant is 2.7 s.",
        "The 63 % rule counts from the command, so it adds the converter's lag of 0.30 s to the valve's 2.7 s; the "
        "thesis, whose record cannot show the difference, may have done the same. A fit separates the two.",
        (
            Number("63 % of the step after", 2.7, rise_s, "s", 1),
            Number("that, less the converter's lag", 2.7, rise_s - DESIGN.ep_tau_s, "s", 1),
            Number("fit of the model", None, fit_percent(x, model), "%", 1),
        ),
        draw,
    )


def figure_2_7() -> Entry:
    """The complete model."""
    run = play(levels(SERIES, 25.0))
    model = simulated(run, DESIGN)

    def draw(canvas: Canvas) -> None:
        axes = canvas.subplots()
        axes.plot(run.time_s, run.position, color=BLUE, lw=1.2, label="virtual valve")
        axes.plot(run.time_s, model, color=RED, lw=0.8, ls="--", label="complete model")
        axes.set(xlabel="time [s]", ylabel="position [in]")
        axes.legend(frameon=False, loc="upper right")

    error = 100.0 * (run.position - model) / DESIGN.travel
    return Entry(
        "2-7",
        "Figure 2-7: the complete model over the series of pressures",
        "Cross-plotted with the record; called a success (no number).",
        "Play, saturation, rate limit, lag and converter lag. What is left is the reading noise and the slow unrest of "
        "the converter.",
        (
            Number("fit", None, fit_percent(run.position, model), "%", 2),
            Number("root mean square difference", None, float(np.sqrt(np.mean(error**2))), "% of travel", 2),
        ),
        draw,
        command="lostmotion simulate MODEL.toml RUN --out FILE.csv",
    )
