"""Play elements compiled: pressure in, target of the stem out. They know no time, only the order of the pressures.

The two backlash curves arrive as tables over a uniform pressure grid, so that every effect which bends them (spring,
friction spot, flow force) costs nothing more here; a table of two points is a straight line and is not looked up.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def _straight_play(
    force: FloatArray,
    widening: FloatArray,
    spread: float,
    weight: float,
    low: float,
    high: float,
    curves: FloatArray,
    w0: float,
    out: FloatArray,
) -> None:
    """Adds `weight` times one element to `out`; `curves` is (slope, value at pressure 0) closing, then opening."""
    k1, b1, k2, b2 = curves[0], curves[1], curves[2], curves[3]
    e = max(low, min(high, w0))
    varies = widening.size > 1
    band = spread + widening[0]
    for f in range(force.size):
        if varies:
            band = spread + widening[f]
        bottom = max(low, min(high, b1 + k1 * (force[f] - band)))
        top = max(low, min(high, b2 + k2 * (force[f] + band)))
        e = max(bottom, min(top, e))
        out[f] += weight * e


@njit(cache=True, nogil=True, error_model="numpy")
def look_up(p: float, p_first: float, p_step: float, table: FloatArray) -> float:
    """Linear interpolation in a uniform table, extended by its end slopes."""
    q = (p - p_first) / p_step
    i = min(max(int(q), 0), table.size - 2)
    value: float = table[i] + (q - i) * (table[i + 1] - table[i])
    return value


@njit(cache=True, nogil=True, error_model="numpy")
def _bent_play(
    force: FloatArray,
    widening: FloatArray,
    spread: float,
    weight: float,
    low: float,
    high: float,
    p_first: float,
    p_step: float,
    closing: FloatArray,
    opening: FloatArray,
    w0: float,
    out: FloatArray,
) -> None:
    """Adds `weight` times one element between two curves given as tables to `out`."""
    e = max(low, min(high, w0))
    varies = widening.size > 1
    band = spread + widening[0]
    for f in range(force.size):
        if varies:
            band = spread + widening[f]
        bottom = max(low, min(high, look_up(force[f] - band, p_first, p_step, closing)))
        top = max(low, min(high, look_up(force[f] + band, p_first, p_step, opening)))
        e = max(bottom, min(top, e))
        out[f] += weight * e


@njit(cache=True, nogil=True, error_model="numpy")
def _mean_at(v: float, bottom: FloatArray, top: FloatArray, weights: FloatArray) -> float:
    """Output of elements that all stand as near to `v` as their bounds allow."""
    total = 0.0
    for j in range(weights.size):
        total += weights[j] * max(bottom[j], min(top[j], v))
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def common_start(
    force: float,
    widening: float,
    stops: tuple[float, float],
    tables: tuple[float, float, FloatArray, FloatArray],
    spreads: FloatArray,
    weights: FloatArray,
    w0: float,
) -> float:
    """Where all elements have to stand, as far as the pressure lets each, for their output to be `w0`.

    At rest narrow elements are at their bounds and wide ones are not: the same place for all would move the stem.
    """
    if spreads.size < 2:
        return w0
    bottom, top = np.empty(spreads.size), np.empty(spreads.size)
    for j in range(spreads.size):
        band = spreads[j] + widening
        bottom[j] = max(stops[0], min(stops[1], look_up(force - band, tables[0], tables[1], tables[2])))
        top[j] = max(stops[0], min(stops[1], look_up(force + band, tables[0], tables[1], tables[3])))
    low, high = min(bottom.min(), w0), max(top.max(), w0)
    for _ in range(50):
        v = 0.5 * (low + high)
        if _mean_at(v, bottom, top, weights) < w0:
            low = v
        else:
            high = v
    return float(0.5 * (low + high))


def play_target(
    force: FloatArray,
    widening: FloatArray,
    stops: tuple[float, float],
    tables: tuple[float, float, FloatArray, FloatArray],
    spreads: FloatArray,
    weights: FloatArray,
    w0: float,
) -> FloatArray:
    """Sum of the play elements, shape of `force`. `widening` is added to every half width: one number or one each."""
    p_first, p_step, closing, opening = tables
    low, high = stops
    out = np.zeros(force.size)
    straight = closing.size == 2 and opening.size == 2
    for spread, weight in zip(spreads.tolist(), weights.tolist(), strict=True):
        if straight:
            k1, k2 = (closing[1] - closing[0]) / p_step, (opening[1] - opening[0]) / p_step
            line = np.array([k1, closing[0] - k1 * p_first, k2, opening[0] - k2 * p_first])
            _straight_play(force, widening, spread, weight, low, high, line, w0, out)
        else:
            curves = (p_first, p_step, closing, opening)
            _bent_play(force, widening, spread, weight, low, high, *curves, w0, out)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def plain_play(values: FloatArray, half: float, start: float, out: FloatArray) -> None:
    """Fills `out` with what a play of half width `half` passes on of `values`; its follower begins at `start`."""
    e = start
    for f in range(values.size):
        e = max(values[f] - half, min(values[f] + half, e))
        out[f] = e
