"""The converter's lag toward its goal: a compiled pass."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.ep_slots import EP_TAU_FALL_S, EP_TAU_RISE_S

_SAME = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def follow(
    time_s: FloatArray, offsets: np.ndarray, goal: FloatArray, c: FloatArray, p0: float, out: FloatArray
) -> None:
    """A lag toward the goal, exact for a goal that is constant within a fine step."""
    per_row = goal.size == time_s.size
    p = p0
    out[0] = p
    last_h = -1.0
    e_rise = e_fall = 0.0
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h = h
            e_rise = np.exp(-h / max(c[EP_TAU_RISE_S], 1e-12))
            e_fall = np.exp(-h / max(c[EP_TAU_FALL_S], 1e-12))
        v = goal[i]
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            if not per_row:
                v = goal[f]
            p = v + (p - v) * (e_rise if v > p else e_fall)
            out[f] = p
