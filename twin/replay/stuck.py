"""Play and stem that act on each other, row by row: the loops of `twin/kernels` with their state kept."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.play import common_start
from twin.kernels.valve import coupled_coefficients, coupling
from twin.kernels.valve_slots import V_HIGH, V_LOW, stem_stops
from twin.model.coefficients import Coefficients
from twin.model.plant import curve_tables


class Stuck:
    """Stem with friction in its own motion; `x0`: the stem, `w0`: the play output at the start."""

    def __init__(self, c: Coefficients, x0: float, w0: float) -> None:
        v = coupled_coefficients(c.valve)
        stops = np.array([v[V_LOW], v[V_HIGH], *stem_stops(v)])
        first, step, closing, opening = curve_tables(c)
        tables = (float(first), float(step), closing, opening)
        self._what = (v, stops, tables, (c.spreads, c.weights), c.stem_bends)
        self._start = (x0, w0)
        self._begin, self._steps = coupling(v)
        self._kept: tuple[FloatArray, FloatArray] | None = None

    def advance(self, time_s: FloatArray, offsets: np.ndarray, force: FloatArray, widening: FloatArray) -> FloatArray:
        """The stem on the fine points of the row."""
        if self._kept is None:
            f, wide = float(force[0]), float(widening[0])
            _, stops, tables, plays, _ = self._what
            at = common_start(f, wide, (float(stops[0]), float(stops[1])), tables, *plays, self._start[1])
            self._kept = self._begin(f, wide, *self._what, (self._start[0], at))
        out = np.empty(force.size)
        self._steps(time_s, offsets, force, widening, *self._what, *self._kept, out)
        return out
