"""The position sensor one row at a time: `twin/kernels/sensor.py` with its state between the rows."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from logs.recording import FloatArray
from twin.kernels.sensor import filters, lags_s, leading, static_reading, swings
from twin.kernels.sensor_slots import S_HOLD_PHASE_S, S_HOLD_S, S_LEADS_S, S_STEP, S_WINDOW_S, S_WINDOWS
from twin.kernels.sinking import core_at_first, core_of, first_core
from twin.kernels.slipping import slipped, slips
from twin.replay.lag import Lag
from twin.replay.mean import Mean
from twin.replay.swing import Swing


class Sensor:
    """Stem in, reading out. The first row's time is `origin_s`, its stem `x0`.

    `core`: where the core of a loose linkage stands; not a number: with the stem.
    """

    def __init__(self, c: FloatArray, origin_s: float, x0: float, core: float = math.nan) -> None:
        self._c = c
        self._origin_s = origin_s
        self._core = first_core(c, x0, core)
        self._slipped = 0.0
        lags, filters_of_two = [Lag(float(one)) for one in lags_s(c)], [Swing(*map(float, one)) for one in swings(c)]
        self._filters: list[Lag | Swing] = [*lags, *filters_of_two]
        self._means = [Mean(float(c[S_WINDOW_S])) for _ in range(int(c[S_WINDOWS]))]
        self._rows: deque[tuple[float, float]] = deque(
            [(0.0, float(self._static(np.array([core_at_first(c, self._core)]), np.zeros(1))[0]))]
        )

    @property
    def first(self) -> float:
        """The reading at the first row."""
        return self._rounded(self._rows[0][1])

    def advance(self, time_s: FloatArray, offsets: np.ndarray, stem: FloatArray) -> float:
        """The reading at the end of the row; `stem` on its fine points."""
        c = self._c
        t = np.linspace(time_s[0], time_s[1], stem.size) - self._origin_s
        if c[S_LEADS_S] != 0.0:
            stem = leading(t, stem, c[S_LEADS_S])  # the first point is the last of the row before, and counts no more
        if slips(c):
            gone = self._slipped + slipped(t, stem, c)
            stem, self._slipped = stem - gone, float(gone[-1])
        stem, self._core = core_of(t, stem, c, self._core)
        if filters(c):
            late = self._static(stem, t)
            for one in self._filters:
                late = one.follow(time_s, offsets, late)
            for mean in self._means:
                late = mean.follow(t, late)
            value = float(late[-1])
        else:
            value = float(self._static(stem[-1:], t[-1:])[0])
        if c[S_HOLD_S] > 0.0:
            value = self._refreshed(float(t[-1]), value)
        return self._rounded(value)

    def _static(self, stem: FloatArray, t: FloatArray) -> FloatArray:
        return static_reading(stem, t, self._c)

    def _refreshed(self, t: float, value: float) -> float:
        """The value of the last refresh instant; rows before it are forgotten."""
        rows = self._rows
        rows.append((t, value))
        period = float(self._c[S_HOLD_S])
        at = np.floor((t - self._c[S_HOLD_PHASE_S]) / period) * period + self._c[S_HOLD_PHASE_S]
        while len(rows) > 1 and rows[1][0] <= at:
            rows.popleft()
        if at <= 0.0 or len(rows) == 1:
            return rows[0][1]
        (t0, y0), (t1, y1) = rows[0], rows[1]
        return float(y0 + (at - t0) / (t1 - t0) * (y1 - y0))

    def _rounded(self, value: float) -> float:
        step = float(self._c[S_STEP])
        return float(np.round(value / step) * step) if step > 0.0 else value
