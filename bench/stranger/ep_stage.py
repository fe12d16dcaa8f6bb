"""The converter, one step: the pressure follows the command through one lag, exact over a step of constant target."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bench.stranger.kernel import STEP_S, compiled
from bench.stranger.valve import Ep

#: Places of the converter's state.
PRESSURE, HELD, PLAYED, CLOCK, EP_STATES = 0, 1, 2, 3, 4
LINE_STEPS = 4096  # longest dead time in steps of the plant


@compiled
def _target(ep: Ep, state: NDArray[np.float64], wanted_psi: float) -> float:
    """The pressure [psi] that the pilot works towards: hysteresis of the input, then the supply's ceilings."""
    if abs(wanted_psi - state[HELD]) > ep.hold_psi:
        state[HELD] = wanted_psi
    half = 0.5 * ep.play_psi
    state[PLAYED] = max(state[HELD] - half, min(state[HELD] + half, state[PLAYED]))
    target = min(state[PLAYED], ep.target_ceiling_psi)
    bend_psi = 0.25
    if target > ep.soft_ceiling_psi - 8.0 * bend_psi:
        target = ep.soft_ceiling_psi - bend_psi * math.log1p(math.exp((ep.soft_ceiling_psi - target) / bend_psi))
    return float(target)


@compiled
def ep_step(
    ep: Ep, state: NDArray[np.float64], line: NDArray[np.float64], command_psi: float, added_psi: float
) -> float:
    """Advances by one step and returns the pressure [psi]. `line` holds the last commands (the dead time)."""
    clock = int(state[CLOCK])
    line[clock % LINE_STEPS] = command_psi
    delayed = line[(clock - round(ep.delay_s / STEP_S)) % LINE_STEPS]
    state[CLOCK] = clock + 1
    error = _target(ep, state, ep.gain * delayed + ep.zero_psi + added_psi) - state[PRESSURE]
    error = math.copysign(max(abs(error) - ep.overlap_psi, 0.0), error)
    tau_s = ep.tau_fill_s if error > 0.0 else ep.tau_exhaust_s
    change = error * (1.0 - math.exp(-STEP_S / tau_s))
    change = max(-ep.fall_limit_psi_s * STEP_S, min(ep.rise_limit_psi_s * STEP_S, change))
    state[PRESSURE] = min(state[PRESSURE] + change, ep.pressure_ceiling_psi)
    return float(state[PRESSURE])
