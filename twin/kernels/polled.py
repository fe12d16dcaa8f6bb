"""A converter that looks at its command in fixed cycles, as a controller scans its inputs: compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def polled(
    time_s: FloatArray, goal: FloatArray, offsets: np.ndarray, clock: tuple[float, float], held: float, out: FloatArray
) -> float:
    """Fills `out` (fine) with the goal, per row or fine, as last seen: its mean over each fine step.

    `clock`: an instant at which it is seen, and the cycle [s]; `held`: what was seen last. Returns what is at the end.
    """
    per_row, (first_s, cycle_s) = goal.size == time_s.size, clock
    out[0] = held
    count = np.floor((time_s[0] - first_s) / cycle_s)
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            ends = time_s[i - 1] + (f - offsets[i - 1]) * h if f < offsets[i] else time_s[i]
            new, now = goal[i] if per_row else goal[f], np.floor((ends - first_s) / cycle_s)
            out[f] = held
            if now > count:  # counted, so that an instant on the edge of a step is in one of the two
                out[f] += (new - held) * min(max((ends - first_s - (count + 1.0) * cycle_s) / h, 0.0), 1.0)
                held, count = new, now
    return held
