"""The converter's lag toward its goal with an overlap band, limited slopes and a supply that sinks: a compiled pass."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.slots import (
    EP_BAND,
    EP_BAND_MODE,
    EP_CLIP,
    EP_DRAW,
    EP_LEAK,
    EP_RATE_DOWN,
    EP_RATE_UP,
    EP_REFILL_S,
    EP_TANK,
    EP_TAU_FALL_S,
    EP_TAU_RISE_S,
    FOREVER,
)


@njit(cache=True, nogil=True, error_model="numpy")
def _leaking_step(p: float, v: float, h: float, c: FloatArray) -> float:
    """Pressure after `h` seconds of a lag whose gain within the band is a share of that outside; exact."""
    tau_s = max(c[EP_TAU_RISE_S] if v > p else c[EP_TAU_FALL_S], 1e-12)
    band, leak = c[EP_BAND], c[EP_LEAK]
    error = abs(v - p)
    if error > band:
        rate, rest = (1.0 + leak) / tau_s, band / (1.0 + leak)
        inside_s = h - (np.log((error - rest) / (band - rest)) / rate if leak > 0.0 else np.inf)
        if inside_s <= 0.0:
            error = rest + (error - rest) * np.exp(-rate * h)
            return v - error if v > p else v + error
        error, h = band, inside_s
    error *= np.exp(-h * leak / tau_s)
    return v - error if v > p else v + error


@njit(cache=True, nogil=True, error_model="numpy")
def _bounded_step(p: float, v: float, h: float, c: FloatArray) -> float:
    """Pressure after `h` seconds of a lag toward `v`, with overlap band and slope limits."""
    mode, goal = c[EP_BAND_MODE], v
    if mode == 4.0 and abs(v - p) <= c[EP_BAND]:
        return p
    tau_s = c[EP_TAU_RISE_S] if goal > p else c[EP_TAU_FALL_S]
    new = goal if tau_s <= 0.0 else goal + (p - goal) * np.exp(-h / tau_s)
    if mode == 3.0:
        new = _leaking_step(p, v, h, c)
    if mode == 4.0:
        new = min(new, v - c[EP_BAND]) if v > p else max(new, v + c[EP_BAND])
    bounded: float = min(c[EP_CLIP], max(p - c[EP_RATE_DOWN] * h, min(p + c[EP_RATE_UP] * h, new)))
    return bounded


@njit(cache=True, nogil=True, error_model="numpy")
def follow_bounded(
    time_s: FloatArray,
    offsets: np.ndarray,
    goal: FloatArray,
    c: FloatArray,
    p0: float,
    sunk: FloatArray,
    out: FloatArray,
) -> None:
    """A lag toward the goal with an overlap band and limited slope; `sunk[0]`: how far the supply has sunk, kept."""
    per_row = goal.size == time_s.size
    p = p0
    out[0] = p
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            v = min(goal[i] if per_row else goal[f], c[EP_TANK] - sunk[0])
            new = _bounded_step(p, v, h, c)
            if c[EP_TANK] < FOREVER:
                sunk[0] = sunk[0] * np.exp(-h / c[EP_REFILL_S]) + c[EP_DRAW] * max(new - p, 0.0)
            p = new
            out[f] = p
