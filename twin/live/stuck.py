"""Play and stem that act on each other, one row at a time: what `twin/kernels/coupled.py` does, with its state kept.

The loop over the few fine steps of a row is plain Python around the same compiled steps; a compiled loop here would
not notice edits over there.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.effect import Coefficients
from twin.kernels.coupled import Grown, State, _breakaway, _decays, _half_band, _move, _play_step
from twin.plant import curve_tables
from twin.slots import (
    FOREVER,
    V_HARD_HIGH,
    V_HARD_LOW,
    V_HIGH,
    V_IN_MOTION,
    V_LOW,
    V_STICK_SPEED,
    V_TARGET_STICKS,
)


class Stuck:
    """Stem with friction in its own motion; `x0`: the stem, `w0`: the play output at the start."""

    def __init__(self, c: Coefficients, x0: float, w0: float) -> None:
        v = c.valve
        self._c = v
        self._tables = curve_tables(c)
        self._plays = (c.spreads, c.weights)
        self._bends = c.stem_bends
        stem_low, stem_high = max(v[V_LOW], v[V_HARD_LOW]), min(v[V_HIGH], v[V_HARD_HIGH])
        self._stops = np.array([v[V_LOW], v[V_HIGH], stem_low, stem_high])
        self._elements = np.full(c.spreads.size, w0)
        self._state: State = (max(stem_low, min(stem_high, x0)), w0, w0, True, 0.0, 0.0, 0.0, FOREVER)
        self._modes = (bool(v[V_STICK_SPEED] >= FOREVER), bool(v[V_TARGET_STICKS] != 0.0))
        self._lags = np.zeros((3, 2))
        self._begun = False

    def advance(self, time_s: FloatArray, offsets: np.ndarray, force: FloatArray, widening: FloatArray) -> FloatArray:
        """The stem on the fine points of the row."""
        if not self._begun:
            self._begun = True
            grown = _half_band(float(widening[0]), self._state, self._c, self._bends)
            w, _ = self._play(float(force[0]), grown, (0.0, 0.0), (False, False))
            self._state = (self._state[0], w, w, *self._state[3:])
        step_s = (time_s[1] - time_s[0]) / offsets[1]
        _decays(step_s, self._c, self._lags)
        out = np.empty(force.size)
        out[0] = self._state[0]
        for f in range(1, force.size):
            self._step(step_s, float(force[f]), float(widening[f if widening.size > 1 else 0]))
            out[f] = self._state[0]
        return out

    def _step(self, step_s: float, force: float, wide: float) -> None:
        c, state = self._c, self._state
        if c[V_IN_MOTION] != 0.0:
            self._elements += c[V_IN_MOTION] * (state[0] - state[1])
        grown = _half_band(wide, state, c, self._bends)
        w, slipped = self._play(force, grown, _breakaway(state, c), self._modes)
        self._state = _move(step_s, w, slipped, c, self._stops, self._lags, state)

    def _play(
        self, force: float, grown: Grown, extra: tuple[float, float], modes: tuple[bool, bool]
    ) -> tuple[float, bool]:
        elements = (self._stops, self._tables, self._plays, self._elements)
        w, slipped = _play_step(force, grown, extra, modes, *elements)
        return float(w), bool(slipped)
