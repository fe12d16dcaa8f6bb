"""Plays on a spring of which a part relaxes, compiled: pressure in, target of the stem out.

The play and its spring are of what moves the stem: it takes r (w - z) more pressure to hold the target at w, of which z
comes after. It goes on relaxing while friction holds the target, which so comes free earlier one way than the other.
Source: Findley, Lai, Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials (1976), ch. 5 (standard solid).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Plays, Tables
from twin.kernels.play import look_up

#: Rounds in which the target and what it loads the spring by agree: each leaves the relaxing share of what was missing.
_ROUNDS = 4


@njit(cache=True, nogil=True, error_model="numpy")
def _step(
    p: float, wide: float, stops: tuple[float, float], tables: Tables, plays: Plays, elements: FloatArray, keep: bool
) -> float:
    """Where the plays bring the target at pressure `p`; they stay there if they are to be kept."""
    first, step, closing, opening = tables
    total = 0.0
    for j in range(elements.size):
        band = plays[0][j] + wide
        bottom = max(stops[0], min(stops[1], look_up(p - band, first, step, closing)))
        top = max(stops[0], min(stops[1], look_up(p + band, first, step, opening)))
        e = max(bottom, min(top, elements[j]))
        total += plays[1][j] * e
        if keep:
            elements[j] = e
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def relaxing_target(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    stops: tuple[float, float],
    tables: Tables,
    plays: Plays,
    relax: tuple[float, float],
    elements: FloatArray,
    state: FloatArray,
) -> FloatArray:
    """The target, shape of `force`; moves `elements` and `state` on: the target, and where its spring has relaxed to.

    `relax`: pressure for each distance that the spring at first takes, and in which time it lets go; `state`: not
    numbers at first, when all has relaxed. `force`, `widening`, `stops` as for the plays.
    """
    out = np.empty(force.size)
    varies = widening.size > 1
    if np.isnan(state[0]):
        state[0] = state[1] = _step(force[0], widening[0], stops, tables, plays, elements, True)
    w, late = state[0], state[1]
    out[0] = w
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        stay = np.exp(-h / relax[1])
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            wide = widening[f if varies else 0]
            for k in range(_ROUNDS):
                loaded = force[f] - relax[0] * (w - late)
                w = _step(loaded, wide, stops, tables, plays, elements, k == _ROUNDS - 1)
            late = w + (late - w) * stay
            out[f] = w
    state[0], state[1] = w, late
    return out
