"""The bench of chapter 3 (`--physics chapter3`), trials on it, and the commands that repeat them."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
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
PERIOD_S = 0.1
SEED = 1
# Three standard deviations of a reading: what a rule that cannot see it should leave alone.
TOLERANCE_IN = 0.0018


@dataclass(frozen=True, slots=True)
class Case:
    """A controller through steps in percent of travel, as `lostmotion run` does it from a vented valve.

    The trial has no wire, for speed; `command` does the same over Modbus.
    """

    controller: str
    settings: Mapping[str, float] = field(default_factory=dict)
    steps: Sequence[float] = STEPS
    hold_s: float = HOLD_S
    physics: str = "chapter3"

    def trial(self, seed: int = SEED) -> Trace:
        """The trial, with the true stem."""
        targets = np.repeat(np.asarray(self.steps) * DESIGN.travel / 100.0, round(self.hold_s / PERIOD_S))
        controller = make_controller(self.controller, DESIGN, **self.settings)
        return run_trial(open_virtual(seed, name=self.physics), controller, targets, PERIOD_S)

    def tails(self, seed: int = SEED) -> FloatArray:
        """The errors in the last third of every hold of a trial."""
        return tails(self.trial(seed), self.hold_s)

    def command(self, seed: int = SEED) -> str:
        """What to type for the same over Modbus."""
        targets = ",".join(f"{step * DESIGN.travel / 100.0:.6g}" for step in self.steps)
        words = ["lostmotion", "run", "--controller", self.controller, "--targets", targets]
        words += ["--hold", f"{self.hold_s:g}", "--physics", self.physics, "--seed", str(seed)]
        for key, value in self.settings.items():
            words += ["--set", f"{key}={value:g}"]
        return shlex.join(words)


def tails(trace: Trace, hold_s: float = HOLD_S) -> FloatArray:
    """The errors in the last third of every hold, shape (holds, rows) [% of travel]."""
    n = round(hold_s / PERIOD_S)
    error = 100.0 * (trace.truth_in - trace.target_in) / DESIGN.travel
    return np.asarray(error.reshape(-1, n)[:, -n // 3 :])


def response(trace: Trace, canvas: Canvas) -> None:
    """Target and stem over time, pressure below."""
    upper, lower = canvas.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    stem(trace, upper)
    upper.legend(frameon=False, loc="upper left", fontsize=8)
    lower.plot(trace.time_s, trace.pressure_psi, color=ORANGE, lw=0.8)
    lower.set(xlabel="time [s]", ylabel="pressure [psi]")


def stem(trace: Trace, axes) -> None:  # type: ignore[no-untyped-def]
    """Target and stem over time."""
    axes.plot(trace.time_s, 100.0 * trace.target_in / DESIGN.travel, color=GREY, lw=1.0, label="target")
    axes.plot(trace.time_s, 100.0 * trace.truth_in / DESIGN.travel, color=BLUE, lw=1.0, label="stem")
    axes.set_ylabel("position [%]")


def swing(tail: FloatArray, steps: Sequence[float] = STEPS) -> float:
    """The largest peak to peak of a hold that does not end at a stop [%]."""
    return float(max(np.ptp(row) for row in inner(tail, steps)))


def inner(tail: FloatArray, steps: Sequence[float] = STEPS) -> list[FloatArray]:
    """The holds that do not end at a stop."""
    return [row for row, step in zip(tail, steps, strict=True) if 0.0 < step < 100.0]


def first_move(trace: Trace, row: int) -> int:
    """Rows after `row` until the stem has left where it was by 2 % of travel."""
    moved = np.abs(trace.truth_in[row:] - trace.truth_in[row]) > 0.02 * DESIGN.travel
    return int(np.argmax(moved)) if moved.any() else moved.size
