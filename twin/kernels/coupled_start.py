"""Where play and stem stand at rest, for the loop of `twin/kernels/coupled.py`."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Bends, Plays, Tables
from twin.kernels.slots import FOREVER
from twin.kernels.valve_slots import V_BREAKAWAY, V_ON_STEM, V_OUTER, V_STRIBECK, V_TARGET_STICKS, V_TRAVEL, V_WITHIN


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _curve_at(p: float, grid: tuple[float, float], table: FloatArray) -> float:
    """Linear interpolation at `p` in a table, extended by its end slopes; `grid`: first point, points per unit."""
    q = (p - grid[0]) * grid[1]
    i = min(max(int(q), 0), table.size - 2)
    value: float = table[i] + (q - i) * (table[i + 1] - table[i])
    return value


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _unheld(free: float, held: float, inside: bool, ends: tuple[float, float]) -> float:
    """Where the breakaway holds an element, if what the stops keep the play from does not pull at it."""
    return held + min(ends[1], max(ends[0], free)) - free if inside else held


@njit(cache=True, nogil=True, error_model="numpy")
def coupled_start(
    force: float,
    wide: float,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    plays: Plays,
    bends: Bends,
    start: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """State (see `coupled_steps`) and elements at rest; `start`: (x, w), `stops`: of the play, of the stem.

    What rests has stuck, and may have been left anywhere that the breakaway, too, can hold it.
    """
    grid, ends, inside = (tables[0], 1.0 / tables[1]), (stops[0], stops[1]), c[V_TARGET_STICKS] == 1.0
    elements = np.full(plays[0].size, start[1])
    x = max(stops[2], min(stops[3], start[0]))
    wide = min(wide, -c[V_OUTER]) if c[V_ON_STEM] > 0.0 else wide
    more = less = wide + (c[V_STRIBECK] if c[V_STRIBECK] > 0.0 else 0.0)
    softer = 1.0
    if bends[0].size > 1:
        place = (0.0, (bends[0].size - 1) / c[V_TRAVEL])
        more, less = more + _curve_at(x, place, bends[0]), less - _curve_at(x, place, bends[1])
        softer = _curve_at(x, place, bends[2])
    w = over = 0.0
    for j in range(elements.size):
        down, up = force - plays[0][j] - more, force + plays[0][j] + less
        bottom, top = softer * _curve_at(down, grid, tables[2]), softer * _curve_at(up, grid, tables[3])
        reach = max(bottom, min(top, elements[j]))
        if c[V_BREAKAWAY] > 0.0:
            low = softer * _curve_at(down - c[V_BREAKAWAY], grid, tables[2])
            high = softer * _curve_at(up + c[V_BREAKAWAY], grid, tables[3])
            stays = _unheld(bottom, low, inside, ends) <= elements[j] <= _unheld(top, high, inside, ends)
            reach = elements[j] if stays else reach
        elements[j] = max(ends[0], min(ends[1], reach))
        w, over = w + plays[1][j] * elements[j], over + plays[1][j] * (reach - elements[j])
    return np.array([x, w, w, 1.0, 0.0, 0.0, 0.0, FOREVER, (1.0 - c[V_WITHIN]) * over, x]), elements
