"""A filter of second order that carries its state from one row to the next, on top of the compiled pass."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.second_order import second_order_pass

_NONE_S = 1e-9


class Swing:
    """Feeds blocks of fine points, each beginning with the last point of the block before, through one filter."""

    __slots__ = ("_damping", "_natural_s", "_state")

    def __init__(self, natural_s: float, damping: float) -> None:
        self._natural_s, self._damping = natural_s, damping
        self._state: FloatArray | None = None

    def follow(self, time_s: FloatArray, offsets: np.ndarray, values: FloatArray) -> FloatArray:
        """The block behind the filter, shape of `values`; `time_s` (2,) are its ends, `offsets` (0, steps)."""
        if self._natural_s <= _NONE_S:
            return values
        if self._state is None:
            self._state = np.array([values[0], 0.0])
        out = np.empty_like(values)
        second_order_pass(time_s, offsets, values, self._natural_s, self._damping, self._state, out)
        return out
