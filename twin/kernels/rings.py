"""Elastic rings compiled: play elements whose sum the stops hold, and not each of them.

Rings of a packing that yield before they slip make the same curve as plays side by side. At a stop they stay stretched
as they are, however far the pressure goes on, and so the plays stay where they are, too: a pressure beyond the one that
takes the stem to its stop moves nothing. Plays that end at a stop one by one would come off it too late. The look-up
stands here once more on purpose: see `coupled.py`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Tables
from twin.kernels.play import look_up

#: Halvings of a step of the pressure in which the stem comes to its stop.
_HALVINGS = 45
#: Doublings of a way beyond the ends of a step of the table, by which its curves have passed any position.
_DOUBLINGS = 24


def unstretched_rings(at: float, count: int) -> FloatArray:
    """The state of rings not stretched with the stem `at` a place: the pressure that moved them last, the plays."""
    return np.append(np.nan, np.full(count, at))


@njit(cache=True, nogil=True, error_model="numpy")
def _between(at: float, tables: Tables) -> float:
    """The pressure in the middle of the two curves at a position."""
    first, step, closing, opening = tables
    low, high, wide = first, first + step, step
    for _ in range(_DOUBLINGS):  # never without end: nobody could stop a loop that is compiled
        if look_up(low, first, step, closing) + look_up(low, first, step, opening) > 2.0 * at:
            low -= wide
        if look_up(high, first, step, closing) + look_up(high, first, step, opening) < 2.0 * at:
            high += wide
        wide *= 2.0
    for _ in range(_HALVINGS):
        p = 0.5 * (low + high)
        if look_up(p, first, step, closing) + look_up(p, first, step, opening) < 2.0 * at:
            low = p
        else:
            high = p
    return 0.5 * (low + high)


@njit(cache=True, nogil=True, error_model="numpy")
def _moved(
    p: float, wide: float, tables: Tables, spreads: FloatArray, weights: FloatArray, state: FloatArray, new: FloatArray
) -> float:
    """Fills `new` with where a pressure takes the elements of `state`; returns their sum."""
    first, step, closing, opening = tables
    total = 0.0
    for j in range(spreads.size):
        band = spreads[j] + wide
        bottom = look_up(p - band, first, step, closing)
        top = look_up(p + band, first, step, opening)
        new[j] = max(bottom, min(top, state[1 + j]))
        total += weights[j] * new[j]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def rings_target(
    force: FloatArray,
    widening: FloatArray,
    stops: tuple[float, float],
    tables: Tables,
    spreads: FloatArray,
    weights: FloatArray,
    state: FloatArray,
) -> FloatArray:
    """Target of the stem: the sum of the elements, shape of `force`; moves `state` (see `unstretched_rings`) on.

    `widening`: see `play_target`.
    """
    low, high = stops
    out = np.empty(force.size)
    if np.isnan(state[0]):
        state[0] = _between(state[1], tables)
    new, varies, stop = np.empty(spreads.size), widening.size > 1, 0
    for f in range(force.size):
        p = force[f]
        if not varies and ((stop > 0 and p >= state[0]) or (stop < 0 and p <= state[0])):
            out[f] = high if stop > 0 else low
            continue
        wide = widening[f if varies else 0]
        total = _moved(p, wide, tables, spreads, weights, state, new)
        stop = 1 if total > high else -1 if total < low else 0
        if stop != 0:
            inside, beyond = state[0], p
            for _ in range(_HALVINGS):
                p = 0.5 * (inside + beyond)
                total = _moved(p, wide, tables, spreads, weights, state, new)
                if total > high or total < low:
                    beyond = p
                else:
                    inside = p
            p = inside
            total = _moved(p, wide, tables, spreads, weights, state, new)
        state[0], state[1:] = p, new
        out[f] = max(low, min(high, total))
    return out
