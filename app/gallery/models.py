"""Section 2.2: a model identified from one record, held against records that it has not seen (2-4, 2-5, 2-7)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from app.fit_picture import fit_percent
from app.gallery.figure import BLUE, GREY, RED, Entry, Number
from app.gallery.record import SEEDS, Sweep, identified, on_unseen, settled, simulated, typical
from control.identify_steps import crossing_s, together, without_lag
from logs.recording import FloatArray, Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

HOLD_S = 25.0
RANDOM = Sweep("random", {"low": 5.5, "high": 12.0, "count": 40, "dwell_min_s": HOLD_S, "dwell_max_s": HOLD_S})
BEFORE_S = 80.0
STEP = Sweep("points", {"points": [[10.0, 0.0, BEFORE_S], [10.25, 0.0, HOLD_S]]})
LEVELS = (0.0, 9.5, 10.5, 11.5, 10.5, 9.5, 8.5, 7.5, 8.5, 9.5, 10.5, 12.0, 11.0, 9.0, 7.0, 5.0, 4.0)
SERIES = Sweep("points", {"points": [[level, 0.0, HOLD_S] for level in LEVELS]})
SHOWN = "The model is the one that `lostmotion identify` makes of one staircase; the records are others, unseen."


def spread(what: str, values: Mapping[int, float], unit: str, digits: int) -> tuple[Number, ...]:
    """Median and range over the seeds."""
    found = np.array(list(values.values()))
    parts = (("median", np.median(found)), ("least", found.min()), ("largest", found.max()))
    return tuple(Number(f"{what}, {name} of {found.size}", None, float(v), unit, digits) for name, v in parts)


def residual_panel(axes: Axes, at: FloatArray, percent: FloatArray, mark: str = "-") -> None:
    """What the model leaves, in percent of travel."""
    axes.plot(at, percent, mark, color=GREY, lw=0.7, ms=3)
    axes.axhline(0.0, color="0.85", lw=0.6, zorder=0)
    axes.set_ylabel("record - model\n[% of travel]", fontsize=8)


def _fit(measured: FloatArray, model: FloatArray) -> float:
    found = fit_percent(measured, model)
    assert found is not None, "a record of a valve that moves"
    return found


def _percent(difference: FloatArray) -> FloatArray:
    return 100.0 * difference / identified().design.travel


def figure_2_4() -> Entry:
    """Steady positions for a random series of steps."""
    points = {}
    for seed in SEEDS:
        run = RANDOM.record(seed)
        at, measured = settled(run, HOLD_S, run.position)
        points[seed] = (at, measured, settled(run, HOLD_S, simulated(run, identified().design))[1])
    fits = {seed: _fit(measured, model) for seed, (_, measured, model) in points.items()}
    worst = {seed: float(np.abs(_percent(measured - model)).max()) for seed, (_, measured, model) in points.items()}
    seed = typical(fits)
    at, measured, model = points[seed]

    def draw(canvas: Canvas) -> None:
        upper, lower = canvas.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        upper.plot(at, measured, "o", color=BLUE, ms=5, mfc="none", label="virtual valve, settled")
        upper.plot(at, model, "x", color=RED, ms=5, label="identified model")
        upper.set_ylabel("position [in]")
        upper.legend(frameon=False, fontsize=8)
        residual_panel(lower, at, _percent(measured - model), "o")
        lower.set_xlabel("pressure command [psi]")

    return Entry(
        "2-4",
        "Figure 2-4: steady state, model and record",
        "Excellent agreement (no number).",
        f"{SHOWN} A random series of steps; every settled position. Shown is seed {seed}, whose fit is nearest the "
        "median.",
        (*spread("fit", fits, "%", 2), *spread("largest difference", worst, "% of travel", 2)),
        draw,
        (7.2, 4.2),
        command=on_unseen(RANDOM, seed),
    )


def figure_2_5() -> Entry:
    """A step of 0.25 psi and the 63 % rule."""
    design = identified().design
    runs = {seed: _stepped(STEP.record(seed)) for seed in SEEDS}
    fits = {seed: _fit(x, model) for seed, (_, x, model) in runs.items()}
    times = {seed: _rise_s(t, x) for seed, (t, x, _) in runs.items()}
    taus = {seed: without_lag(value, design.ep_tau_s) for seed, value in times.items()}
    shift = {seed: abs(float((x - model).mean())) for seed, (_, x, model) in runs.items()}
    seed = typical(fits)
    t, x, model = runs[seed]

    def draw(canvas: Canvas) -> None:
        upper, lower = canvas.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        upper.plot(t, x, color=BLUE, lw=0.8, label="virtual valve")
        upper.plot(t, model, color=RED, lw=1, label="identified model")
        upper.axvline(times[seed], color=GREY, lw=0.6, ls="--", label=f"63 %: {times[seed]:.1f} s")
        upper.set_ylabel("position [in]")
        upper.legend(frameon=False, loc="lower right", fontsize=8)
        residual_panel(lower, t, _percent(x - model))
        lower.set_xlabel("time since the step [s]")

    return Entry(
        "2-5",
        "Figure 2-5: response to a step of 0.25 psi",
        "By the 63 % rule the time constant is 2.7 s.",
        f"{SHOWN} {_why(max(shift.values()))} Shown is seed {seed}, whose fit is nearest the median.",
        (
            *spread("63 % of the step after", times, "s", 2),
            Number("that, less the converter's lag, median", 2.7, float(np.median(list(taus.values()))), "s", 2),
            *spread("fit", fits, "%", 1),
        ),
        draw,
        (7.2, 4.2),
        command=on_unseen(STEP, seed),
    )


def _why(shift_in: float) -> str:
    """Why the times and the fits of 2-5 are what they are; the mean of a response is off by up to `shift_in`."""
    design = identified().design
    return (
        "The 63 % rule counts from the command, so it finds the converter's lag together with the valve's: "
        f"{design.tau_s:.2f} s behind {design.ep_tau_s:.2f} s reach 63 % after "
        f"{together(design.tau_s, design.ep_tau_s):.2f} s. The thesis, whose record cannot show the difference, may "
        "have done the same. What the fit leaves is the slow unrest of the converter, which bends and shifts "
        f"responses: their mean is off by up to {shift_in:.4f} in, which is "
        f"{100.0 * shift_in / (0.25 * design.compliance):.0f} % of so small a step."
    )


def _stepped(run: Recording) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time since the last step, from 5 s before it on, position, and the model's position."""
    t = run.time_s - BEFORE_S
    rows = t >= -5.0
    return t[rows], run.position[rows], simulated(run, identified().design)[rows]


def _rise_s(t: FloatArray, x: FloatArray) -> float:
    """When 63 % of the step is passed, by a line through what is left of it between 15 and 60 % [s]."""
    first, last = float(x[t < 0.0].mean()), float(x[t > t[-1] - 8.0].mean())
    left = (last - x) / (last - first)
    near = (t > 1.5) & (t < 5.5) & (left > 0.0)
    found = crossing_s(t[near], left[near])
    assert found is not None, "a record of a step"
    return found


def figure_2_7() -> Entry:
    """The complete model."""
    design = identified().design
    runs = {}
    for seed in SEEDS:
        run = SERIES.record(seed)
        runs[seed] = (run, simulated(run, design))
    fits = {seed: _fit(run.position, model) for seed, (run, model) in runs.items()}
    rms = {s: float(np.sqrt(np.mean(_percent(run.position - model) ** 2))) for s, (run, model) in runs.items()}
    seed = typical(fits)
    run, model = runs[seed]

    def draw(canvas: Canvas) -> None:
        upper, lower = canvas.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        upper.plot(run.time_s, run.position, color=BLUE, lw=2.0, label="virtual valve")
        upper.plot(run.time_s, model, color=RED, lw=0.8, label="identified model")
        upper.set_ylabel("position [in]")
        upper.legend(frameon=False, loc="lower center", fontsize=8)
        residual_panel(lower, run.time_s, _percent(run.position - model))
        lower.set_xlabel("time [s]")

    return Entry(
        "2-7",
        "Figure 2-7: the complete model over the series of pressures",
        "Cross-plotted with the record; called a success (no number).",
        f"{SHOWN} Play, saturation, rate limit, lag and converter lag. What is left is the reading noise and the slow "
        f"unrest of the converter. Shown is seed {seed}, whose fit is nearest the median.",
        (*spread("fit", fits, "%", 2), *spread("root mean square difference", rms, "% of travel", 2)),
        draw,
        (7.2, 4.2),
        command=on_unseen(SERIES, seed),
    )
