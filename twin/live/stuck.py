"""Play and stem that act on each other, one row at a time: what `twin/kernels/coupled.py` does, with its state kept.

The loop over the few fine steps of a row is plain Python around the same compiled steps; a compiled loop here would
not notice edits over there.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.effect import Coefficients
from twin.kernels.coupled import _bounded, _decays, _half_band, _play_step, _toward
from twin.plant import curve_tables
from twin.slots import (
    FOREVER,
    V_BREAKAWAY,
    V_HARD_HIGH,
    V_HARD_LOW,
    V_HELD,
    V_HIGH,
    V_IN_MOTION,
    V_LOW,
    V_STICK_SPEED,
)


class Stuck:
    """Stem with friction in its own motion; `x0`: the stem, `w0`: the play output at the start."""

    def __init__(self, c: Coefficients, x0: float, w0: float) -> None:
        v = c.valve
        self._c = v
        self._tables = curve_tables(c)
        self._plays = (c.spreads, c.weights)
        stem_low, stem_high = max(v[V_LOW], v[V_HARD_LOW]), min(v[V_HIGH], v[V_HARD_HIGH])
        self._stops = np.array([v[V_LOW], v[V_HIGH], stem_low, stem_high])
        self._elements = np.full(c.spreads.size, w0)
        self._x = max(stem_low, min(stem_high, x0))
        self._w = self._after = w0
        self._stuck, self._travelled, self._speed = True, 0.0, 0.0
        self._at_once = bool(v[V_STICK_SPEED] >= FOREVER)
        self._lags = np.zeros((3, 2))
        self._begun = False

    def advance(self, time_s: FloatArray, offsets: np.ndarray, force: FloatArray, widening: FloatArray) -> FloatArray:
        """The stem on the fine points of the row."""
        if not self._begun:
            self._begun = True
            elements = (self._stops, self._tables, self._plays, self._elements)
            self._w, _ = _play_step(force[0], widening[0], 0.0, False, *elements)
            self._after = self._w
        step_s = (time_s[1] - time_s[0]) / offsets[1]
        _decays(step_s, self._c, self._lags)
        out = np.empty(force.size)
        out[0] = self._x
        for f in range(1, force.size):
            out[f] = self._step(step_s, float(force[f]), float(widening[f if widening.size > 1 else 0]))
        return out

    def _step(self, step_s: float, force: float, wide: float) -> float:
        c, x = self._c, self._x
        grown = _half_band(wide, self._travelled, self._speed, c)
        if c[V_IN_MOTION] != 0.0:
            self._elements += c[V_IN_MOTION] * (x - self._w)
        extra = float(c[V_BREAKAWAY]) if self._stuck else 0.0
        w, slipped = _play_step(
            force, grown, extra, self._at_once, self._stops, self._tables, self._plays, self._elements
        )
        after = _toward(self._after, self._w, w, self._lags[2])
        lag = self._lags[0 if self._after + after > 2.0 * x else 1]
        new = _bounded(x, _toward(x, self._after, after, lag), step_s, c, self._stops)
        if c[V_HELD] > 0.0:
            slipped = abs(after - x) > c[V_HELD]
            new = x if self._stuck and not slipped else new
        self._speed = abs(new - x) / step_s
        self._stuck = (self._stuck and not slipped) or self._speed < c[V_STICK_SPEED]
        self._travelled += abs(new - x)
        self._x, self._w, self._after = new, w, after
        return float(new)
