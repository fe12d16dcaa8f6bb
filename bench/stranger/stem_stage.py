"""The moving stem: from the play to the stem's position, with what can happen on the way."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bench.stranger.kernel import STEP_S, compiled
from bench.stranger.play_stage import flow_psi, play_step
from bench.stranger.valve import Stem

#: Places of the stem's state.
TUBE, SLOW_PSI, WANTED, SLOW, SLOWER, PLUG, STEM, END, MOVES, HELD, LAST, QUIET_S, SNAP, STEM_STATES = range(14)


@compiled
def toward(value: float, target: float, tau_s: float) -> float:
    """One lag over one step, exact for a constant target; no lag at `tau_s` 0."""
    return target if tau_s <= 0.0 else target + (value - target) * math.exp(-STEP_S / tau_s)


@compiled
def _force_psi(stem: Stem, state: NDArray[np.float64], pressure_psi: float) -> float:
    """The pressure [psi] that acts on the stem: tubing, a diaphragm that gives way slowly, the fluid."""
    state[TUBE] = toward(state[TUBE], pressure_psi, stem.tubing_tau_s)
    acting = state[TUBE]
    if stem.diaphragm_share != 0.0:
        state[SLOW_PSI] = toward(state[SLOW_PSI], acting, stem.diaphragm_tau_s)
        acting += stem.diaphragm_share * (state[SLOW_PSI] - acting)
    return float(acting - flow_psi(stem, state[STEM]))


@compiled
def _stuck(stem: Stem, state: NDArray[np.float64], play_in: float) -> float:
    """The play output [in] with a slip jump: at every start (Choudhury), or again and again (Stenman)."""
    if stem.stair_psi > 0.0:
        if abs(play_in - state[HELD]) > stem.k_closing * stem.stair_psi:
            state[HELD] = play_in
        return float(state[HELD])
    change = play_in - state[LAST]
    state[LAST] = play_in
    if stem.jump_psi <= 0.0:
        return play_in
    state[QUIET_S] = state[QUIET_S] + STEP_S if abs(change) < 1e-3 * STEP_S else 0.0
    if state[QUIET_S] > 0.2:
        state[MOVES] = 0.0
    if abs(play_in - state[HELD]) > stem.k_closing * stem.jump_psi:
        state[MOVES] = 1.0
    if state[MOVES] > 0.5:
        state[HELD] = play_in
    return float(state[HELD])


@compiled
def _slow(stem: Stem, state: NDArray[np.float64], play_in: float) -> float:
    """Adds what comes between play and lag [in]: slow tails, a second lag, a region that is jumped over."""
    wanted = play_in
    if stem.creep_share != 0.0 or stem.tail_share != 0.0:
        state[SLOW] = toward(state[SLOW], play_in, stem.creep_tau_s)
        state[SLOWER] = toward(state[SLOWER], play_in, stem.tail_tau_s)
        wanted += stem.creep_share * (state[SLOW] - play_in) + stem.tail_share * (state[SLOWER] - play_in)
    state[PLUG] = toward(state[PLUG], wanted, stem.plug_tau_s)
    wanted = state[PLUG]
    if stem.snap_half_in > 0.0:
        if abs(wanted - stem.snap_at_in) >= stem.snap_half_in:
            state[SNAP] = math.copysign(1.0, stem.snap_at_in - wanted)
        else:  # whoever comes in on one side is thrown out at the other
            wanted = stem.snap_at_in + stem.snap_half_in * state[SNAP]
    return float(wanted)


@compiled
def _error_in(stem: Stem, state: NDArray[np.float64], wanted_in: float, band_added_psi: float) -> float:
    """How far the stem [in] is from where it goes; 0 while friction holds it."""
    error = wanted_in - state[STEM]
    if stem.friction_share > 0.0:
        whole_psi = 0.5 * (stem.closing_psi - stem.opening_psi + band_added_psi)
        error = math.copysign(max(abs(error) - stem.k_closing * whole_psi * stem.friction_share, 0.0), error)
    if stem.stick_psi > 0.0:
        breakaway_in = stem.k_closing * stem.stick_psi
        if abs(error) > breakaway_in:
            state[MOVES] = 1.0
        elif abs(error) < 0.1 * breakaway_in:
            state[MOVES] = 0.0
        error *= state[MOVES]
    return float(error)


@compiled
def stem_step(
    stem: Stem,
    state: NDArray[np.float64],
    plays_in: NDArray[np.float64],
    pressure_psi: float,
    band_added_psi: float,
    locked: bool,
) -> float:
    """Advances by one step and returns the stem's position [in]; the lag sees the mean target of the step."""
    before = state[WANTED]
    play_in = play_step(stem, plays_in, _force_psi(stem, state, pressure_psi), band_added_psi)
    state[WANTED] = _slow(stem, state, _stuck(stem, state, play_in))
    error = _error_in(stem, state, 0.5 * (before + state[WANTED]), band_added_psi)
    tau_s = stem.tau_closing_s if error > 0.0 else stem.tau_opening_s
    change = error * (1.0 - math.exp(-STEP_S / tau_s))
    most = 0.0 if locked else stem.rate_limit_in_s * STEP_S
    moved = state[STEM] + max(-most, min(most, change))
    state[STEM] = max(stem.low_stop_in, min(stem.high_stop_in, moved))
    state[END] = toward(state[END], state[STEM], stem.stem_tau_s)
    return float(state[END])
