"""What a converter's goal is measured by and held back to: a zero that may drift, a supply that may swing."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.ep_slots import (
    EP_CLIP,
    EP_CUT,
    EP_DRIFTS,
    EP_DRIFTS_S,
    EP_KNEE,
    EP_SUPPLY,
    EP_SWING_COS,
    EP_SWING_SIN,
    EP_SWINGS_S,
    EP_ZERO,
)
from twin.kernels.slots import FOREVER


def zero(c: FloatArray, time_s: FloatArray, offsets: np.ndarray, size: int, began_s: float) -> float | FloatArray:
    """Zero error of a converter, one that drifts: per row or fine, as `size` has it. `began_s`: when the drift did."""
    if c[EP_DRIFTS] == 0.0:
        return float(c[EP_ZERO])
    at_s = _since(time_s, offsets, size, began_s)
    drifted: FloatArray = c[EP_ZERO] + c[EP_DRIFTS] * -np.expm1(-at_s / c[EP_DRIFTS_S])
    return drifted


def supply(c: FloatArray, time_s: FloatArray, offsets: np.ndarray, size: int, began_s: float) -> float | FloatArray:
    """Highest goal that the supply allows, one that swings: per row or fine, as `size` has it."""
    return float(c[EP_SUPPLY]) + (_swing(c, time_s, offsets, size, began_s) if c[EP_SUPPLY] < FOREVER else 0.0)


def cut(c: FloatArray, time_s: FloatArray, offsets: np.ndarray, began_s: float) -> FloatArray:
    """Pressure at which the supply cuts it off, fine where it swings; of size 1 where it does not, or nothing does."""
    if c[EP_CUT] == FOREVER:
        return c[EP_CLIP : EP_CLIP + 1]
    highest: FloatArray = np.minimum(c[EP_CLIP], c[EP_CUT] + _swing(c, time_s, offsets, int(offsets[-1]) + 1, began_s))
    return highest


def _swing(c: FloatArray, time_s: FloatArray, offsets: np.ndarray, size: int, began_s: float) -> float | FloatArray:
    """How far the supply is above its mean: per row or fine, as `size` has it. `began_s`: when the recording did."""
    if c[EP_SWINGS_S] == 0.0:
        return 0.0
    angle = 2.0 * np.pi / c[EP_SWINGS_S] * _since(time_s, offsets, size, began_s)
    swung: FloatArray = c[EP_SWING_COS] * np.cos(angle) + c[EP_SWING_SIN] * np.sin(angle)
    return swung


def _since(time_s: FloatArray, offsets: np.ndarray, size: int, began_s: float) -> FloatArray:
    """Time since `began_s` per row or fine, as `size` has it."""
    at_s = time_s if size == time_s.size else np.interp(np.arange(size), offsets, time_s)
    since: FloatArray = at_s - began_s
    return since


def supplied(goal: FloatArray, highest: float | FloatArray, c: FloatArray) -> FloatArray:
    """The goal below the supply: the smaller of the two, or with a knee a softened minimum of them."""
    most: FloatArray = np.minimum(goal, highest)
    if c[EP_KNEE] > 0.0:
        most -= c[EP_KNEE] * np.log1p(np.exp(-np.abs(goal - highest) / c[EP_KNEE]))
    return most
