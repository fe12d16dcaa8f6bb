"""A pilot that swings to its goal, of second order with little damping; the lag of the converter follows it.

Exact for a goal that is constant within a fine step. Source: Franklin, Powell, Emami-Naeini, Feedback Control of
Dynamic Systems, ch. 3 (response of second order).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.ep_slots import EP_DAMPING, EP_RINGS_S


@njit(cache=True, nogil=True, error_model="numpy")
def ringing_pass(
    time_s: FloatArray, offsets: np.ndarray, goal: FloatArray, c: FloatArray, state: FloatArray, out: FloatArray
) -> None:
    """Fills `out` (fine) with the pilot's mean over each fine step, from a `goal` per row or fine.

    Moves `state` (pressure, its slope) on.
    """
    per_row = goal.size == time_s.size
    decay = c[EP_DAMPING] / c[EP_RINGS_S]
    turns = np.sqrt(1.0 - c[EP_DAMPING] ** 2) / c[EP_RINGS_S]
    p, slope = state[0], state[1]
    out[0] = p
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        less, sine, cosine = np.exp(-decay * h), np.sin(turns * h), np.cos(turns * h)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            u = goal[i] if per_row else goal[f]
            before, off = p, p - u
            beside = (slope + decay * off) / turns
            p = u + less * (off * cosine + beside * sine)
            slope = less * ((beside * turns - decay * off) * cosine - (off * turns + decay * beside) * sine)
            out[f] = 0.5 * (before + p)
    state[0], state[1] = p, slope
