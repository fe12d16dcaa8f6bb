"""The bench of chapter 3, whose imperfections the thesis's observations emerge from, and how its trials are shown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from app.gallery.figure import BLUE, GREY, ORANGE
from app.physics_bench import open_virtual
from control.controller import make_controller
from control.design import DesignModel
from control.trial import Trace, run_trial
from logs.recording import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

DESIGN = DesignModel()
STEPS = (25.0, 50.0, 75.0, 100.0, 75.0, 50.0, 25.0, 0.0)
HOLD_S = 90.0
# The converter stops 0.07 psi above its set point when it lets air out (a hysteresis that was calibrated away for
# filling), and the springs are 5 % stiffer than table 2-1 says.
RELIEVING: Mapping[str, float] = {"ep_deadband/play": 0.07, "ep_calibration/zero": 0.035}
NUMBERS: Mapping[str, float] = {"compliance": 0.18}


def trial(
    name: str,
    steps: Sequence[float] = STEPS,
    hold_s: float = HOLD_S,
    *,
    plain: bool = False,
    seed: int = 1,
    **settings: float,
) -> Trace:
    """A controller through steps in percent of travel, on the bench of chapter 3, or on a valve as designed."""
    targets = np.repeat(np.asarray(steps) * DESIGN.travel / 100.0, round(hold_s * 10))
    opened = open_virtual(seed) if plain else open_virtual(seed, effects=RELIEVING, numbers=NUMBERS)
    return run_trial(opened, make_controller(name, DESIGN, **settings), targets, 0.1, start_psi=5.0)


def tails(trace: Trace, hold_s: float = HOLD_S) -> FloatArray:
    """The errors in the last third of every hold, shape (holds, rows) [% of travel]."""
    n = round(hold_s * 10)
    error = 100.0 * (trace.truth_in - trace.target_in) / DESIGN.travel
    return np.asarray(error.reshape(-1, n)[:, -n // 3 :])


def response(trace: Trace, canvas: Canvas) -> None:
    """Target and stem over time, pressure below."""
    upper, lower = canvas.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    upper.plot(trace.time_s, 100.0 * trace.target_in / DESIGN.travel, color=GREY, lw=1.0, label="target")
    upper.plot(trace.time_s, 100.0 * trace.truth_in / DESIGN.travel, color=BLUE, lw=1.0, label="stem")
    upper.set_ylabel("position [%]")
    upper.legend(frameon=False, loc="upper left", fontsize=8)
    lower.plot(trace.time_s, trace.pressure_psi, color=ORANGE, lw=0.8)
    lower.set(xlabel="time [s]", ylabel="pressure [psi]")


def swing(tail: FloatArray) -> float:
    """The largest peak to peak of a hold that does not end at a stop [%]."""
    inner = [row for row, step in zip(tail, STEPS, strict=True) if 0.0 < step < 100.0]
    return float(max(np.ptp(row) for row in inner))


def first_move(trace: Trace, row: int) -> int:
    """Rows after `row` until the stem has left where it was by 2 % of travel."""
    moved = np.abs(trace.truth_in[row:] - trace.truth_in[row]) > 0.02 * DESIGN.travel
    return int(np.argmax(moved)) if moved.any() else moved.size
