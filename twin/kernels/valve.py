"""The valve: pressure on the fine grid in, true stem position on the fine grid out, as a row of compiled passes.

Where target and stem do not act on each other the passes are separate and each is a tight loop; where they do
(`twin/kernels/coupled.py`) one loop does both. Each pass is exact for inputs that are linear within a fine step.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from logs.recording import FloatArray
from twin.kernels.active import acts
from twin.kernels.check_valve import eased_pass
from twin.kernels.coupled import coupled_steps
from twin.kernels.coupled_start import coupled_start
from twin.kernels.dahl import dahl_target
from twin.kernels.elastic import elastic_start, elastic_steps
from twin.kernels.in_time import as_unbroken, breaks, widening_at, widens
from twin.kernels.inertia import inertia_pass
from twin.kernels.inputs import Bends, Plays, Tables
from twin.kernels.lag import elapsed_s, lagged
from twin.kernels.play import common_start, plain_play, play_target
from twin.kernels.relaxing import relaxing_target
from twin.kernels.rings import rings_target, unstretched_rings
from twin.kernels.rounded import rounded_start, rounded_steps
from twin.kernels.stem import stem_pass
from twin.kernels.tails import creep_tails, held_by_tails, stops_of_pull, stretch_tails, unstretched, within_stops
from twin.kernels.valve_slots import (
    V_BREAKAWAY,
    V_DAHL,
    V_DAHL_HALF,
    V_DRAG_CLOSE_S,
    V_DRAG_OPEN_S,
    V_EASES,
    V_EASES_AT,
    V_FORCE_CREEP,
    V_FORCE_CREEP_TAU_S,
    V_HELD,
    V_HIGH,
    V_IN_MOTION,
    V_INERTIA_S,
    V_KEPT,
    V_LOW,
    V_ON_STEM,
    V_OUTER,
    V_OUTER_CENTRE,
    V_OUTER_SLOPE,
    V_PRESLIDING,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_RELAX,
    V_RELAX_TARGET,
    V_RELAX_TAU_S,
    V_RINGS,
    V_ROUNDED,
    V_SHORT,
    V_SQUARED_S,
    V_STRETCHES,
    V_STRIBECK,
    V_TARGET_CREEPS,
    V_TAU_AFTER_S,
    V_TAU_BEFORE_S,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_WEAR,
    stem_stops,
)

_SQUARED = (V_SQUARED_S, V_SQUARED_S + 1)
_STIFF = np.array([V_BREAKAWAY, V_HELD, V_SHORT, V_KEPT, V_TAU_AFTER_S, V_ON_STEM, *_SQUARED, V_EASES, V_EASES + 1])
_DRAG = (V_DRAG_CLOSE_S, V_DRAG_OPEN_S, *_SQUARED)
_COUPLING = np.array(
    [V_IN_MOTION, V_BREAKAWAY, V_WEAR, V_STRIBECK, V_HELD, V_SHORT, V_KEPT, V_ON_STEM, V_RELAX, *_DRAG]
)
#: A speed that follows within so short a time follows at once [s].
_AT_ONCE_S = 1e-4


def valve_kernel(
    time_s: FloatArray,
    pressure: FloatArray,
    offsets: np.ndarray,
    c: FloatArray,
    tables: Tables,
    plays: Plays,
    bends: Bends,
    start: tuple[float, float],
    out: FloatArray,
) -> None:
    """Fills `out` with the stem position. `plays`: by how much each element widens the half deadband [pressure], its
    weight; `start`: stem and play output at the first row.
    """
    force = _force(time_s, offsets, pressure, c, start[1])
    widening = _widening(time_s, offsets, c)
    tables = (float(tables[0]), float(tables[1]), *tables[2:])
    start = unstretched(c, (float(start[0]), float(start[1])))
    held = 0.0 if couples(c, bends) else held_by_tails(force, widening, c, tables, plays, start)
    after = c[V_TARGET_CREEPS] == 0.0 or couples(c, bends)
    first = (start[0] - held, start[1] - held) if after else start
    _stem(time_s, offsets, force, widening, c, tables, plays, bends, first, held, out)
    if c[V_STRETCHES] != 0.0:
        stretch_tails(time_s, offsets, c, out)
    elif after:
        creep_tails(time_s, offsets, c, held, out)


def couples(c: FloatArray, bends: Bends) -> bool:
    """Whether target and stem act on each other."""
    return acts(c, _COUPLING) or bends[0].size > 1


def coupled_coefficients(c: FloatArray) -> FloatArray:
    """What the loops for target and stem that act on each other are given: to them inertia is a second lag, and a
    spring is of the stem."""
    if c[V_INERTIA_S] <= _AT_ONCE_S and c[V_RELAX_TARGET] == 0.0:
        return c
    known = c.copy()
    known[V_TAU_AFTER_S] += c[V_INERTIA_S] if c[V_INERTIA_S] > _AT_ONCE_S else 0.0
    known[V_RELAX] += c[V_RELAX_TARGET]
    return known


def coupling(c: FloatArray) -> tuple[Callable[..., tuple[FloatArray, FloatArray]], Callable[..., None]]:
    """Start and steps of the loop for target and stem that act on each other.

    Friction that turns over a distance, or with the speed, has one of its own, except beside what only the other knows.
    """
    if c[V_ROUNDED] > 0.0 and c[V_IN_MOTION] == 1.0 and c[V_STRIBECK] == 0.0 and not acts(c, _STIFF):
        return rounded_start, rounded_steps
    elastic = c[V_PRESLIDING] > 0.0 and c[V_IN_MOTION] == 1.0 and not acts(c, _STIFF)
    return (elastic_start, elastic_steps) if elastic else (coupled_start, coupled_steps)


def _stem(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    tables: Tables,
    plays: Plays,
    bends: Bends,
    start: tuple[float, float],
    held: float,
    out: FloatArray,
) -> None:
    """Fills `out` with the stem before any creep: in one loop where target and stem act on each other, else in two.

    `held`: see `held_by_tails`.
    """
    low, high = stem_stops(c)
    if couples(c, bends):
        at = common_start(float(force[0]), float(widening[0]), (c[V_LOW], c[V_HIGH]), tables, *plays, start[1])
        stops = np.array([c[V_LOW], c[V_HIGH], low, high])
        c = coupled_coefficients(c)
        what = (c, stops, tables, plays, bends)
        begin, steps = coupling(c)
        state, elements = begin(float(force[0]), float(widening[0]), *what, (start[0], at))
        steps(time_s, offsets, force, widening, *what, state, elements, out)
    else:
        target = _target(time_s, offsets, force, widening, c, tables, plays, start[1])
        if c[V_TARGET_CREEPS] != 0.0:
            creep_tails(time_s, offsets, c, held, target)
            within_stops(c, target)
        target = lagged(time_s, offsets, target, c[V_TAU_AFTER_S])
        move_stem(time_s, offsets, target, c, np.array([start[0], 0.0]), out)


def _target(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    tables: Tables,
    plays: Plays,
    w0: float,
) -> FloatArray:
    """What pulls the stem, from `w0`: Dahl's friction, or plays that begin at a place."""
    stops = stops_of_pull(c)
    at = common_start(float(force[0]), float(widening[0]), stops, tables, *plays, w0)
    if c[V_DAHL] > 0.0:
        return dahl_target(force, widening, stops, tables, c[V_DAHL_HALF], c[V_DAHL], np.array([w0, np.nan]))
    if c[V_RINGS] > 0.0:
        return rings_target(force, widening, stops, tables, *plays, unstretched_rings(at, plays[0].size))
    if c[V_RELAX_TARGET] != 0.0:
        relax, state = (c[V_RELAX_TARGET], c[V_RELAX_TAU_S]), np.full(2, np.nan)
        elements = np.full(plays[0].size, at)
        return relaxing_target(time_s, offsets, force, widening, stops, tables, plays, relax, elements, state)
    return play_target(force, widening, stops, tables, *plays, at)


def move_stem(
    time_s: FloatArray, offsets: np.ndarray, target: FloatArray, c: FloatArray, state: FloatArray, out: FloatArray
) -> None:
    """Fills `out` with the stem that follows `target`; moves `state` (stem, speed) on."""
    low, high = stem_stops(c)
    lags_s, rates = c[[V_TAU_CLOSE_S, V_TAU_OPEN_S]], c[[V_RATE_CLOSE, V_RATE_OPEN]]
    eases = (c[V_EASES], c[V_EASES + 1], c[V_EASES_AT])
    if c[V_INERTIA_S] > _AT_ONCE_S:
        stops = np.array([low, high])
        inertia_pass(time_s, offsets, target, lags_s, rates, stops, c[V_INERTIA_S], eases, state, out)
        return
    if eases[0] > 0.0 or eases[1] > 0.0:
        eased_pass(time_s, offsets, target, lags_s, rates, (low, high), eases, state[0], out)
    else:
        stem_pass(time_s, offsets, target, lags_s, rates, low, high, state[0], out)
    state[0] = out[-1]


def _force(time_s: FloatArray, offsets: np.ndarray, pressure: FloatArray, c: FloatArray, w0: float) -> FloatArray:
    """The pressure that reaches the play: lagged, creeping, after a break what the old spring takes as much of, behind
    an outer play."""
    force = lagged(time_s, offsets, pressure, c[V_TAU_BEFORE_S])
    if c[V_FORCE_CREEP] != 0.0:
        late = lagged(time_s, offsets, force, c[V_FORCE_CREEP_TAU_S])
        force = force + c[V_FORCE_CREEP] * (late - force)
    if breaks(c):
        force = as_unbroken(force, elapsed_s(time_s, offsets), c)
    if c[V_OUTER] > 0.0:
        inner = np.empty_like(force)
        plain_play(force, c[V_OUTER], c[V_OUTER_CENTRE] + c[V_OUTER_SLOPE] * w0, inner)
        force = inner
    return force


def _widening(time_s: FloatArray, offsets: np.ndarray, c: FloatArray) -> FloatArray:
    """How much wider the half deadband is than at the start: one number, or one for each fine point [pressure]."""
    return widening_at(elapsed_s(time_s, offsets), c) if widens(c) else np.array([-c[V_OUTER]])
