"""Converter and valve together: command in, pressure and stem out.

Mostly the one drives the other and nothing comes back. Where the stem takes air from a converter, a replay goes over
the two until they agree, which they soon do where little air is taken (waveform relaxation: Lelarasmee, Ruehli,
Sangiovanni-Vincentelli, IEEE Trans. CAD 1 (1982) 131). Live, and where they do not, the two go side by side through
short blocks: the converter is told how the stem went in the block before, and afterwards how much further it did go,
because no air is lost.
"""

from __future__ import annotations

import math

import numpy as np

from logs.recording import FloatArray
from twin.kernels.ep import boosted
from twin.kernels.ep_slots import EP_AIR, EP_STROKE
from twin.model.coefficients import Coefficients
from twin.model.plant import pressure_response, stem_response
from twin.model.timegrid import TimeGrid
from twin.replay.converter import Converter
from twin.replay.valve import Valve

#: Longest block [s]: a stem changes its speed over its lag, and an inner step of the kernels is shorter.
_BLOCK_S = 0.05
#: Rounds of a replay, and what the stem may still change in the last one, as a share of travel.
_ROUNDS, _AGREE = 25, 3e-5


def takes_air(c: FloatArray) -> bool:
    """Whether the stem acts back on the pressure; `c`: the converter's coefficients."""
    return bool(c[EP_STROKE] != 0.0 or (boosted(c) and c[EP_AIR] > 0.0))


def chain_response(
    c: Coefficients, grid: TimeGrid, command: FloatArray, p0: float, x0: float, w0: float
) -> tuple[FloatArray, FloatArray]:
    """Pressure and stem on the fine grid, shape (n_fine,); start as for `pressure_response` and `stem_response`."""
    pressure = pressure_response(c, grid, command, p0)
    stem = stem_response(c, grid, pressure, x0, w0)
    if not takes_air(c.ep):
        return pressure, stem
    for _ in range(_ROUNDS):
        before, pressure = stem, pressure_response(c, grid, command, p0, stem)
        stem = stem_response(c, grid, pressure, x0, w0)
        if np.max(np.abs(stem - before)) < _AGREE * c.design.travel:
            return pressure, stem
    return _side_by_side(c, grid, command, p0, (x0, w0))


def _side_by_side(
    c: Coefficients, grid: TimeGrid, command: FloatArray, p0: float, start: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Both through short blocks: some fifty times as long as a round, and it always ends."""
    chain = Chain(c, float(grid.time_s[0]), float(command[0]), p0, start)
    pressure, stem = np.empty(grid.n_fine), np.empty(grid.n_fine)
    pressure[0], stem[0] = p0, start[0]
    for i in range(1, grid.time_s.size):
        row = slice(int(grid.offsets[i - 1]), int(grid.offsets[i]) + 1)
        ends, steps = grid.time_s[i - 1 : i + 1], row.stop - row.start - 1
        pressure[row], stem[row] = chain.advance(ends, steps, float(command[i]))
    return pressure, stem


class Chain:
    """Both row by row. `time_s`, `command`: the first row; `p0`, `start`: the pressure, the stem and the play there."""

    def __init__(self, c: Coefficients, time_s: float, command: float, p0: float, start: tuple[float, float]) -> None:
        self._converter = Converter(c.ep, time_s, command, p0)
        self._valve = Valve(c, time_s, *start)
        self._back = takes_air(c.ep)
        self._stem, self._speed = start[0], 0.0

    def advance(self, ends: FloatArray, steps: int, command: float) -> tuple[FloatArray, FloatArray]:
        """Pressure and stem on the `steps` + 1 fine points of a row from `ends[0]` to `ends[1]`."""
        blocks = math.ceil((ends[1] - ends[0]) / _BLOCK_S - 1e-9) if self._back else 1
        edges = np.unique(np.linspace(0, steps, min(blocks, steps) + 1).round().astype(np.int64))
        if edges.size == 2:
            return self._block(ends, steps, command)
        time_s = ends[0] + (ends[1] - ends[0]) * edges / steps
        pressure, stem = np.empty(steps + 1), np.empty(steps + 1)
        for k in range(1, edges.size):
            block = slice(int(edges[k - 1]), int(edges[k]) + 1)
            pressure[block], stem[block] = self._block(time_s[k - 1 : k + 1], int(edges[k] - edges[k - 1]), command)
        return pressure, stem

    def _block(self, ends: FloatArray, steps: int, command: float) -> tuple[FloatArray, FloatArray]:
        lasts_s, offsets = float(ends[1] - ends[0]), np.array([0, steps], dtype=np.int64)
        going = self._stem + self._speed * lasts_s * np.linspace(0.0, 1.0, steps + 1)
        pressure = self._converter.advance(ends, offsets, command, going)
        stem = self._valve.advance(ends, offsets, pressure)
        pressure[-1] = self._converter.swept(float(stem[-1] - going[-1]), float(stem[-1]))
        self._stem, self._speed = float(stem[-1]), float(stem[-1] - stem[0]) / lasts_s
        return pressure, stem
