"""The valve one row at a time: the compiled passes of `twin/kernels` with the state between the rows."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from logs.recording import FloatArray
from twin.kernels import valve as kernels
from twin.kernels.dahl import dahl_target
from twin.kernels.in_time import as_unbroken, breaks, widening_at, widens
from twin.kernels.play import common_start, plain_play, play_target
from twin.kernels.relaxing import relaxing_target
from twin.kernels.rings import rings_target, unstretched_rings
from twin.kernels.tails import held_by_tails, stops_of_pull, unstretched, within_stops
from twin.kernels.valve_slots import (
    V_CREEP1,
    V_CREEP1_TAU_S,
    V_CREEP2,
    V_CREEP2_TAU_S,
    V_DAHL,
    V_DAHL_HALF,
    V_FORCE_CREEP,
    V_FORCE_CREEP_TAU_S,
    V_OUTER,
    V_OUTER_CENTRE,
    V_OUTER_SLOPE,
    V_RELAX_TARGET,
    V_RELAX_TAU_S,
    V_RINGS,
    V_STRETCHED,
    V_STRETCHES,
    V_TARGET_CREEPS,
    V_TAU_AFTER_S,
    V_TAU_BEFORE_S,
    stem_stops,
)
from twin.model.coefficients import Coefficients
from twin.model.plant import curve_tables
from twin.replay.lag import Lag
from twin.replay.stuck import Stuck


class Mover(Protocol):
    """What carries the stem through one row."""

    def advance(
        self, time_s: FloatArray, offsets: np.ndarray, force: FloatArray, widening: FloatArray
    ) -> FloatArray: ...


class Valve:
    """Pressure in, stem out. `x0`: the stem, `w0`: the play output at the first row, whose time is `origin_s`."""

    def __init__(self, c: Coefficients, origin_s: float, x0: float, w0: float) -> None:
        self._all, self._c = c, c.valve
        self._origin_s = origin_s
        self._before = Lag(float(c.valve[V_TAU_BEFORE_S]))
        self._force_tail = Lag(float(c.valve[V_FORCE_CREEP_TAU_S]))
        self._outer = float(c.valve[V_OUTER_CENTRE] + c.valve[V_OUTER_SLOPE] * w0)
        self._start = (x0, w0)
        self._moved: tuple[Mover, Tails] | None = None

    def advance(self, time_s: FloatArray, offsets: np.ndarray, pressure: FloatArray) -> FloatArray:
        """Stem on the fine points of the row, shape of `pressure`; the first point is the end of the row before."""
        force, widening = self._force(time_s, offsets, pressure), self._widening(time_s, offsets)
        if self._moved is None:
            self._moved = self._at_first(force, widening)
        mover, tails = self._moved
        return tails.follow(time_s, offsets, mover.advance(time_s, offsets, force, widening))

    def _at_first(self, force: FloatArray, widening: FloatArray) -> tuple[Mover, Tails]:
        """What moves the stem, and its tails, as the first pressure has them."""
        c, start = self._all, unstretched(self._c, self._start)
        if couples(c):
            return Stuck(c, *start), Tails(c)
        held = held_by_tails(force, widening, c.valve, curve_tables(c), (c.spreads, c.weights), start)
        if c.valve[V_TARGET_CREEPS] != 0.0:
            return Sliding(c, *start, Tails(c, held)), Tails(None)
        return Sliding(c, start[0] - held, start[1] - held, Tails(None)), Tails(c, held)

    def _force(self, time_s: FloatArray, offsets: np.ndarray, pressure: FloatArray) -> FloatArray:
        c = self._c
        force = self._before.follow(time_s, offsets, pressure)
        if c[V_FORCE_CREEP] != 0.0:
            force = force + c[V_FORCE_CREEP] * (self._force_tail.follow(time_s, offsets, force) - force)
        if breaks(c):
            force = as_unbroken(force, self._elapsed_s(time_s, offsets), c)
        if c[V_OUTER] > 0.0:
            inner = np.empty_like(force)
            plain_play(force, c[V_OUTER], self._outer, inner)
            self._outer = float(inner[-1])
            force = inner
        return force

    def _widening(self, time_s: FloatArray, offsets: np.ndarray) -> FloatArray:
        """What is added to the half deadband: one number, or one for each fine point [pressure]."""
        c = self._c
        return widening_at(self._elapsed_s(time_s, offsets), c) if widens(c) else np.array([-c[V_OUTER]])

    def _elapsed_s(self, time_s: FloatArray, offsets: np.ndarray) -> FloatArray:
        """Time since the beginning at the fine points of the row [s]."""
        return np.linspace(time_s[0], time_s[1], int(offsets[1]) + 1) - self._origin_s


class Tails:
    """Slow tails that replace part of a motion, with their state; none for no coefficients.

    `held`: what they have at first of what was before [position].
    """

    def __init__(self, c: Coefficients | None, held: float = 0.0) -> None:
        tails = ((V_CREEP1, V_CREEP1_TAU_S), (V_CREEP2, V_CREEP2_TAU_S)) if c is not None else ()
        self._tails = [(float(c.valve[a]), Lag(float(c.valve[b]))) for a, b in tails if c is not None and c.valve[a]]
        self._stretches = c.valve if c is not None and c.valve[V_STRETCHES] != 0.0 else None
        whole = sum(share for share, _ in self._tails)
        for _, lag in self._tails:
            lag.ahead = held / whole
        self._begun = False

    def follow(self, time_s: FloatArray, offsets: np.ndarray, values: FloatArray) -> FloatArray:
        """The block of fine values with its tails, shape of `values`."""
        if self._stretches is not None:
            return self._stretched(self._stretches, time_s, offsets, values)
        late = [share * (lag.follow(time_s, offsets, values) - values) for share, lag in self._tails]
        return values + np.sum(late, axis=0) if late else values

    def _stretched(self, c: FloatArray, time_s: FloatArray, offsets: np.ndarray, values: FloatArray) -> FloatArray:
        """The block with what gives way behind it added, up to the stops."""
        if not self._begun:
            for _, lag in self._tails:
                lag.ahead = (c[V_STRETCHED] - 1.0) * float(values[0])
            self._begun = True
        more = [share * lag.follow(time_s, offsets, values) for share, lag in self._tails]
        stretched: FloatArray = np.clip(np.add(values, np.sum(more, axis=0)), *stem_stops(c))
        return stretched


class Sliding:
    """Play and stem where they do not act on each other."""

    def __init__(self, c: Coefficients, x0: float, w0: float, tails: Tails) -> None:
        v = c.valve
        self._tables = curve_tables(c)
        self._stops = stops_of_pull(v)
        self._plays, self._w0 = (c.spreads, c.weights), w0
        self._elements: list[float] = []
        self._rings: FloatArray | None = None
        self._relaxed = np.empty(0)
        self._shares = [(c.spreads[k : k + 1], float(c.weights[k])) for k in range(c.spreads.size)]
        self._tails = tails
        self._after = Lag(float(v[V_TAU_AFTER_S]))
        self._c, self._moving = v, np.array([x0, 0.0])
        self._dahl, self._relaxing = np.array([w0, np.nan]), np.full(2, np.nan)

    def advance(self, time_s: FloatArray, offsets: np.ndarray, force: FloatArray, widening: FloatArray) -> FloatArray:
        """The stem on the fine points of the row."""
        target = self._target(time_s, offsets, force, widening)
        target = self._tails.follow(time_s, offsets, target)
        within_stops(self._c, target)
        target = self._after.follow(time_s, offsets, target)
        out = np.empty(force.size)
        kernels.move_stem(time_s, offsets, target, self._c, self._moving, out)
        return out

    def _target(self, time_s: FloatArray, offsets: np.ndarray, force: FloatArray, widening: FloatArray) -> FloatArray:
        half, distance = self._c[V_DAHL_HALF], self._c[V_DAHL]
        if distance > 0.0:
            return dahl_target(force, widening, self._stops, self._tables, half, distance, self._dahl)
        if not self._elements:
            first = (float(force[0]), float(widening[0]), self._stops, self._tables, *self._plays, self._w0)
            self._elements = [common_start(*first)] * len(self._shares)
            self._relaxed = np.array(self._elements)
            self._rings = unstretched_rings(self._elements[0], len(self._shares)) if self._c[V_RINGS] > 0.0 else None
        if self._rings is not None:
            return rings_target(force, widening, self._stops, self._tables, *self._plays, self._rings)
        if self._c[V_RELAX_TARGET] != 0.0:
            relax, what = self._c[[V_RELAX_TARGET, V_RELAX_TAU_S]], (self._stops, self._tables, self._plays)
            begun = (self._relaxed, self._relaxing)
            return relaxing_target(time_s, offsets, force, widening, *what, (relax[0], relax[1]), *begun)
        target = np.zeros(force.size)
        for k, (spread, weight) in enumerate(self._shares):
            one = play_target(force, widening, self._stops, self._tables, spread, _WHOLE, self._elements[k])
            self._elements[k] = float(one[-1])
            target += weight * one
        return target


_WHOLE = np.ones(1)


def couples(c: Coefficients) -> bool:
    """Whether play and stem act on each other."""
    return kernels.couples(c.valve, c.stem_bends)
