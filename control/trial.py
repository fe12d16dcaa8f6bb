"""One closed-loop trial in stepped time: a controller, a bench, a target per tick; arrays come back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from control.controller import Controller
from hal.bench import Bench
from hal.clock import Clock

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Opened:
    """A bench with its clock. `truth_in` asks the virtual valve where its stem really is; None on a real one."""

    bench: Bench
    clock: Clock
    truth_in: Callable[[], float] | None = None


@dataclass(frozen=True, slots=True)
class Trace:
    """A trial, one row per tick, shape (n,). `command_psi[k]` is the command written in tick k, in force from then on.

    `truth_in` is the true stem where the bench can tell it, else the reading.
    """

    time_s: FloatArray
    target_in: FloatArray
    command_psi: FloatArray
    pressure_psi: FloatArray
    position_in: FloatArray
    truth_in: FloatArray

    @property
    def period_s(self) -> float:
        return float(self.time_s[1] - self.time_s[0])


def run_trial(
    opened: Opened, controller: Controller[Any], targets_in: FloatArray, period_s: float, start_psi: float = 0.0
) -> Trace:
    """Opens the bench, runs the loop, and leaves the valve in its safe state."""
    with opened.bench:
        return follow_targets(opened, controller, targets_in, period_s, start_psi)


def follow_targets(
    opened: Opened, controller: Controller[Any], targets_in: FloatArray, period_s: float, start_psi: float = 0.0
) -> Trace:
    """The loop on an open bench: write the command and read, decide, wait for the next tick.

    As on any bench, what is decided on the readings of tick k goes out in tick k + 1.
    """
    rows: FloatArray = np.empty((targets_in.size, 4))
    bench, command_psi = opened.bench, start_psi
    origin_s = opened.clock.now_s()
    sample = bench.exchange(command_psi)
    state = controller.initial(sample, float(targets_in[0]))
    for tick, target_in in enumerate(targets_in):
        pressure = sample.pressure.value if sample.pressure is not None else float("nan")
        x = sample.position.value
        rows[tick] = (command_psi, pressure, x, opened.truth_in() if opened.truth_in is not None else x)
        state, command_psi = controller.step(state, sample, float(target_in), period_s)
        opened.clock.sleep_until(origin_s + (tick + 1) * period_s)
        sample = bench.exchange(command_psi)
    command, pressure_psi, position_in, truth_in = (rows[:, column].copy() for column in range(4))
    time_s = origin_s + period_s * np.arange(targets_in.size, dtype=np.float64)
    return Trace(time_s, targets_in, command, pressure_psi, position_in, truth_in)
