"""A coupling between the stem and the gauge that slips in quick moves: the gauge is left behind, for good."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.sensor_slots import S_SLIPS, S_SLIPS_ABOVE, S_SLIPS_OPEN


def slips(c: FloatArray) -> bool:
    """Whether the coupling between stem and gauge slips."""
    return bool(c[S_SLIPS] != 0.0 or c[S_SLIPS_OPEN] != 0.0)


def slipped(t: FloatArray, stem: FloatArray, c: FloatArray) -> FloatArray:
    """How far a coupling has slipped since the first point: its share of the way over which the stem was quick.

    It begins to between 0.95 and 1.05 of that speed: what sets in at once is no function that a fit could follow.
    """
    way = np.diff(stem)
    lost = np.where(way > 0.0, c[S_SLIPS], c[S_SLIPS_OPEN]) * way
    above = np.clip(10.0 * (np.abs(way) / (c[S_SLIPS_ABOVE] * np.diff(t)) - 1.0) + 0.5, 0.0, 1.0)
    return np.append(0.0, np.cumsum(above * lost))
