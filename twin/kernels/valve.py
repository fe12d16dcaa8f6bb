"""The valve: pressure on the fine grid in, true stem position on the fine grid out, as a row of compiled passes.

Where target and stem do not act on each other the passes are separate and each is a tight loop; where they do
(`twin/kernels/coupled.py`) one loop does both. Each pass is exact for inputs that are linear within a fine step.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.coupled import Plays, Tables, coupled_pass
from twin.kernels.lag import elapsed_s, lagged
from twin.kernels.play import NO_RESTS, Rests, plain_play, play_target
from twin.kernels.stem import stem_pass
from twin.slots import (
    V_BREAKAWAY,
    V_CREEP1,
    V_CREEP1_TAU_S,
    V_CREEP2,
    V_CREEP2_TAU_S,
    V_DRIFT_AMP,
    V_DRIFT_RATE,
    V_DRIFT_TAU_S,
    V_FORCE_CREEP,
    V_FORCE_CREEP_TAU_S,
    V_HARD_HIGH,
    V_HARD_LOW,
    V_HELD,
    V_HIGH,
    V_IN_MOTION,
    V_LOW,
    V_OUTER,
    V_OUTER_CENTRE,
    V_OUTER_SLOPE,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_STEP,
    V_STEP_TIME_S,
    V_STRIBECK,
    V_TAU_AFTER_S,
    V_TAU_BEFORE_S,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_WEAR,
)

_COUPLING = [V_IN_MOTION, V_BREAKAWAY, V_WEAR, V_STRIBECK, V_HELD]
_CREEPS = ((V_CREEP1, V_CREEP1_TAU_S), (V_CREEP2, V_CREEP2_TAU_S))


def valve_kernel(
    time_s: FloatArray,
    pressure: FloatArray,
    offsets: np.ndarray,
    c: FloatArray,
    p_first: float,
    p_step: float,
    closing: FloatArray,
    opening: FloatArray,
    spreads: FloatArray,
    weights: FloatArray,
    x0: float,
    w0: float,
    out: FloatArray,
    rests: Rests = NO_RESTS,
) -> None:
    """Fills `out` with the stem position. `spreads[j]` widens the half deadband of play element j [pressure].

    At the fine points `rests` play output and stem are set to known positions (twin/fit/rests.py).
    """
    force = _force(time_s, offsets, pressure, c, w0)
    widening = _widening(time_s, offsets, c)
    tables = (float(p_first), float(p_step), closing, opening)
    plays, start = (spreads, weights), (float(x0), float(w0))
    _stem(time_s, offsets, force, widening, c, tables, plays, start, rests, out)
    if rests[0].size and c[[share for share, _ in _CREEPS]].any():
        # The positions are those of the creeping stem; what it lacks there is as the first pass has it just before.
        crept = out.copy()
        _creep(time_s, offsets, c, crept)
        lacks = (out - crept)[np.maximum(rests[0] - 1, 0)]
        _stem(time_s, offsets, force, widening, c, tables, plays, start, (rests[0], rests[1] + lacks), out)
    _creep(time_s, offsets, c, out)


def _stem(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    tables: Tables,
    plays: Plays,
    start: tuple[float, float],
    rests: Rests,
    out: FloatArray,
) -> None:
    """Fills `out` with the stem before any creep: in one loop where target and stem act on each other, else in two."""
    low, high = max(c[V_LOW], c[V_HARD_LOW]), min(c[V_HIGH], c[V_HARD_HIGH])
    # elements and a second lag have their own states, which only the joint loop can set together
    if c[_COUPLING].any() or (rests[0].size and (plays[0].size > 1 or c[V_TAU_AFTER_S] > 0.0)):
        stops = np.array([c[V_LOW], c[V_HIGH], low, high])
        coupled_pass(time_s, offsets, force, widening, c, stops, tables, plays, start, *rests, out)
    else:
        target = play_target(force, widening, (c[V_LOW], c[V_HIGH]), tables, *plays, start[1], rests)
        target = lagged(time_s, offsets, target, c[V_TAU_AFTER_S])
        lags_s, rates = c[[V_TAU_CLOSE_S, V_TAU_OPEN_S]], c[[V_RATE_CLOSE, V_RATE_OPEN]]
        stem_pass(time_s, offsets, target, lags_s, rates, low, high, start[0], *rests, out)


def _force(time_s: FloatArray, offsets: np.ndarray, pressure: FloatArray, c: FloatArray, w0: float) -> FloatArray:
    """The pressure that reaches the play: lagged, creeping, behind an outer play."""
    force = lagged(time_s, offsets, pressure, c[V_TAU_BEFORE_S])
    if c[V_FORCE_CREEP] != 0.0:
        late = lagged(time_s, offsets, force, c[V_FORCE_CREEP_TAU_S])
        force = force + c[V_FORCE_CREEP] * (late - force)
    if c[V_OUTER] > 0.0:
        inner = np.empty_like(force)
        plain_play(force, c[V_OUTER], c[V_OUTER_CENTRE] + c[V_OUTER_SLOPE] * w0, inner)
        force = inner
    return force


def _widening(time_s: FloatArray, offsets: np.ndarray, c: FloatArray) -> FloatArray:
    """How much wider the half deadband is than at the start: one number, or one for each fine point [pressure].

    An outer play takes its width from that of the play behind it.
    """
    if not c[[V_DRIFT_RATE, V_DRIFT_AMP, V_STEP]].any():
        return np.array([-c[V_OUTER]])
    t = elapsed_s(time_s, offsets)
    widening: FloatArray = c[V_DRIFT_RATE] * t - c[V_OUTER]
    if c[V_DRIFT_AMP] != 0.0:
        widening -= c[V_DRIFT_AMP] * np.expm1(-t / c[V_DRIFT_TAU_S])
    if c[V_STEP] != 0.0:
        widening[t >= c[V_STEP_TIME_S]] += c[V_STEP]
    return widening


def _creep(time_s: FloatArray, offsets: np.ndarray, c: FloatArray, out: FloatArray) -> None:
    """Replaces part of the motion by its slow tails."""
    shares = [(c[share], c[tau]) for share, tau in _CREEPS if c[share] != 0.0]
    if shares:
        out += sum(share * (lagged(time_s, offsets, out, tau_s) - out) for share, tau_s in shares)
