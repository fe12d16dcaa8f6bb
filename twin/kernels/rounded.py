"""Play and stem in one loop where friction turns with the speed instead of at once: it is F tanh(v / v0).

So it is in packing with a lubricant film, and in most simulations, which cannot step a jump. Such a stem never sticks:
it creeps on, the more slowly the less pulls it. The speed solves tau v + half tanh(v / v0) = middle - x, which has one
solution; it decays exponentially within a step. The small functions stand here once more on purpose: see `coupled.py`.
Source: Andersson, Soderberg, Bjorklund, Tribology International 40 (2007) 580.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Bends, Plays, Tables
from twin.kernels.valve_slots import (
    V_DRAG_CLOSE_S,
    V_DRAG_OPEN_S,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_RELAX,
    V_RELAX_TAU_S,
    V_ROUNDED,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_TRAVEL,
    V_WEAR,
)

#: Relative accuracy of the speed, and Newton steps for it; where one leaves the bracket, the bracket is halved.
_EXACT, _MOST = 1e-9, 40


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _curve_at(p: float, grid: tuple[float, float], table: FloatArray) -> float:
    """Linear interpolation at `p` in a table, extended by its end slopes; `grid`: first point, points per unit."""
    q = (p - grid[0]) * grid[1]
    i = min(max(int(q), 0), table.size - 2)
    value: float = table[i] + (q - i) * (table[i + 1] - table[i])
    return value


def rounded_start(
    _force: float,
    _wide: float,
    _c: FloatArray,
    stops: FloatArray,
    _tables: Tables,
    _plays: Plays,
    _bends: Bends,
    start: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """State (see `rounded_steps`) with the stem at `start[0]`; nothing else is remembered."""
    x = max(stops[2], min(stops[3], start[0]))
    return np.array([x, 0.0, x]), np.zeros(1)


@njit(cache=True, nogil=True, error_model="numpy")
def _speed(pull: float, half: float, tau_s: float, v0: float) -> tuple[float, float]:
    """The speed (>= 0) at which `pull` (>= 0) is used up, and by what time the speed decays."""
    low, high = max(0.0, pull - half) / tau_s, pull / tau_s
    v = min(high, max(low, pull / (tau_s + half / v0)))
    slope = tau_s
    for _ in range(_MOST):
        turned = np.tanh(v / v0)
        slope = tau_s + half / v0 * (1.0 - turned * turned)
        miss = tau_s * v + half * turned - pull
        if miss > 0.0:
            high = v
        else:
            low = v
        new = v - miss / slope
        if new < low or new > high:
            new = 0.5 * (low + high)
        if abs(new - v) <= _EXACT * high:
            break
        v = new
    return v, slope


@njit(cache=True, nogil=True, error_model="numpy")
def _moved(
    x: float,
    h: float,
    between: tuple[float, float],
    stops: tuple[float, float, float, float],
    lags_s: tuple[float, float],
    drags_s: tuple[float, float],
    rates: tuple[float, float],
    v0: float,
) -> float:
    """The stem after `h`. `between`: the curves, friction against closing and against opening; `stops`: of what it is
    pulled to, of itself; `drags_s`: what drag adds to the lags where no stop limits the pull.
    """
    middle = 0.5 * (between[0] + between[1])
    way = 1.0 if middle > x else -1.0
    tau_s, rate = (lags_s[0], rates[0]) if way > 0.0 else (lags_s[1], rates[1])
    dragged_s = tau_s + (drags_s[0] if way > 0.0 else drags_s[1])
    v, slope = _speed(way * (middle - x), 0.5 * (between[1] - between[0]), max(dragged_s, 1e-9), v0)
    # forces balance between the stops only: beyond, what is too much pulls no harder
    room = max(0.0, stops[1] - x if way > 0.0 else x - stops[0])
    if tau_s * v > room:
        v, slope = room / tau_s, tau_s
    moved = min(v * slope * (1.0 - np.exp(-h / slope)), rate * h)
    new: float = max(stops[2], min(stops[3], x + way * moved))
    return new


@njit(cache=True, nogil=True, error_model="numpy")
def rounded_steps(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    _plays: Plays,
    bends: Bends,
    state: FloatArray,
    _elements: FloatArray,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem and moves `state` (stem, distance travelled, relaxed spring) on."""
    grid, closing, opening = (tables[0], 1.0 / tables[1]), tables[2], tables[3]
    more_at, less_at, softer_at = bends
    bent, place = more_at.size > 1, (0.0, (more_at.size - 1) / c[V_TRAVEL])
    varies, wear, v0 = widening.size > 1, c[V_WEAR], max(c[V_ROUNDED], 1e-9)
    lags_s, rates = (max(c[V_TAU_CLOSE_S], 1e-9), max(c[V_TAU_OPEN_S], 1e-9)), (c[V_RATE_CLOSE], c[V_RATE_OPEN])
    ends, drags_s = (stops[0], stops[1], stops[2], stops[3]), (c[V_DRAG_CLOSE_S], c[V_DRAG_OPEN_S])
    more, less, softer = 0.0, 0.0, 1.0
    x, travelled, late = state[0], state[1], state[2]
    out[0] = x
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            p = 0.5 * (force[f - 1] + force[f]) - c[V_RELAX] * (x - late)
            wide = widening[f if varies else 0] + wear * travelled
            if bent:
                more = _curve_at(x, place, more_at)
                less, softer = _curve_at(x, place, less_at), _curve_at(x, place, softer_at)
            bottom = softer * _curve_at(p - wide - more, grid, closing)
            top = max(bottom, softer * _curve_at(p + wide - less, grid, opening))
            new = _moved(x, h, (bottom, top), ends, lags_s, drags_s, rates, v0)
            travelled += abs(new - x)
            x, late = new, new + (late - new) * np.exp(-h / c[V_RELAX_TAU_S])
            out[f] = x
    state[0], state[1], state[2] = x, travelled, late
