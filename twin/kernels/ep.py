"""The E/P converter compiled: command steps in, pressure on the fine time grid out."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    EP_BAND,
    EP_BAND_MODE,
    EP_DEAD_S,
    EP_GAIN,
    EP_RATE_DOWN,
    EP_RATE_UP,
    EP_SUPPLY,
    EP_TAU_FALL_S,
    EP_TAU_RISE_S,
    EP_ZERO,
)


@njit(cache=True, nogil=True, error_model="numpy")
def _mean_command(time_s: FloatArray, command: FloatArray, start_s: float, stop_s: float, j: int) -> tuple[float, int]:
    """Mean of the command steps over start..stop and the row it ended in; before the first row the first holds."""
    last = time_s.size - 1
    while j < last and time_s[j] <= start_s:
        j += 1
    if time_s[j] >= stop_s or j == last:
        return command[j], j
    total = 0.0
    at = start_s
    k = j
    while at < stop_s:
        end = stop_s if k == last else min(stop_s, time_s[k])
        if end > at:
            total += command[k] * (end - at)
            at = end
        if at < stop_s:
            k += 1
    return total / (stop_s - start_s), j


@njit(cache=True, nogil=True, error_model="numpy")
def _toward(p: float, v: float, h: float, c: FloatArray) -> float:
    """Pressure after `h` seconds of a lag toward `v`, with overlap band and slope limits."""
    mode = c[EP_BAND_MODE]
    goal = v
    if mode >= 3.0:
        error = v - p
        if abs(error) <= c[EP_BAND]:
            return p
        if mode == 3.0:
            goal = v - c[EP_BAND] if error > 0.0 else v + c[EP_BAND]
    tau_s = c[EP_TAU_RISE_S] if goal > p else c[EP_TAU_FALL_S]
    new = goal if tau_s <= 0.0 else goal + (p - goal) * np.exp(-h / tau_s)
    if mode == 4.0:
        edge = v - c[EP_BAND] if v > p else v + c[EP_BAND]
        new = min(new, edge) if v > p else max(new, edge)
    return max(p - c[EP_RATE_DOWN] * h, min(p + c[EP_RATE_UP] * h, new))


@njit(cache=True, nogil=True, error_model="numpy")
def ep_kernel(
    time_s: FloatArray, command: FloatArray, offsets: np.ndarray, c: FloatArray, p0: float, out: FloatArray
) -> None:
    """Fills `out` (shape (offsets[-1] + 1,)) with the pressure; `offsets[i]` is the fine index of row i."""
    out[0] = p0
    p = p0
    held = (p0 - c[EP_ZERO]) / c[EP_GAIN] if c[EP_BAND_MODE] > 0.0 else command[0]
    j = 0
    for i in range(1, time_s.size):
        m = offsets[i] - offsets[i - 1]
        h = (time_s[i] - time_s[i - 1]) / m
        for s in range(m):
            if c[EP_DEAD_S] > 0.0:
                begin = time_s[i - 1] + s * h - c[EP_DEAD_S]
                u, j = _mean_command(time_s, command, begin, begin + h, j)
            else:
                u = command[i]
            if c[EP_BAND_MODE] == 1.0:
                if abs(u - held) > c[EP_BAND]:
                    held = u
            elif c[EP_BAND_MODE] == 2.0:
                held = max(u - c[EP_BAND], min(u + c[EP_BAND], held))
            else:
                held = u
            v = min(c[EP_ZERO] + c[EP_GAIN] * held, c[EP_SUPPLY])
            p = _toward(p, v, h, c)
            out[offsets[i - 1] + s + 1] = p
