"""The polled acquisition: noise, resolution, late refreshes and false readings, row by row."""

from __future__ import annotations

import math

import numpy as np

from bench.stranger.noise import Noise
from bench.stranger.valve import Daq


class Reader:
    """Reads one session of `rows` rows. Chance is drawn when it is made, the same for any size of an effect."""

    def __init__(self, daq: Daq, noise: Noise, rows: int, seed: list[int]) -> None:
        self._daq = daq
        self._position_in = np.random.default_rng([*seed, 1]).normal(0.0, 1.0, rows) * noise.position_in
        self._pressure_psi = np.random.default_rng([*seed, 2]).normal(0.0, 1.0, rows) * noise.pressure_psi
        chance = np.random.default_rng([*seed, 3])
        self._stale, self._false = chance.uniform(size=rows), chance.uniform(size=rows)
        self._way = chance.choice([-1.0, 1.0], rows) * chance.uniform(0.5, 1.5, rows)
        self._refreshes = -1
        self._held = (math.nan, math.nan)

    def read(self, row: int, time_s: float, pressure_psi: float, position_in: float) -> tuple[float, float]:
        """What the file will say: pressure [psi] and position [in]."""
        daq = self._daq
        pressure, position = pressure_psi + self._pressure_psi[row], position_in + self._position_in[row]
        if daq.step_in > 0.0:
            counts = position / daq.step_in
            position = daq.step_in * (math.floor(counts) if daq.truncates else round(counts))
        if self._is_stale(row, time_s):
            position = self._held[1]
            pressure = self._held[0] if daq.stale_pressure else pressure
        self._held = (pressure, position)
        if self._false[row] < daq.false_share:
            position = daq.false_in if daq.false_kind == "value" else position + self._way[row] * daq.false_in
        return float(pressure), float(position)

    def _is_stale(self, row: int, time_s: float) -> bool:
        if math.isnan(self._held[1]):
            return False
        if self._daq.refresh_s > 0.0:
            refreshes = math.floor(time_s / self._daq.refresh_s)
            late = refreshes == self._refreshes
            self._refreshes = refreshes
            return late
        return bool(self._stale[row] < self._daq.stale_share)
