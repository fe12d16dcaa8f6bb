"""A running mean that carries what it still needs from one row to the next, on top of `twin/kernels/mean.py`."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.mean import SHORTEST_S, integral, integral_at


class Mean:
    """Feeds blocks of fine points, each beginning with the last point of the block before, through one running mean."""

    __slots__ = ("_t", "_values", "_whole", "_window_s")

    def __init__(self, window_s: float) -> None:
        self._window_s = window_s
        self._t, self._values, self._whole = np.empty(0), np.empty(0), np.empty(0)

    def follow(self, t: FloatArray, values: FloatArray) -> FloatArray:
        """The mean over the window at the points `t` [s] of the block, shape of `values`."""
        if self._window_s <= SHORTEST_S:
            return values
        if not self._t.size:
            self._t, self._values, self._whole = t[:1], values[:1], np.zeros(1)
        block = self._whole[-1] + integral(t, values)
        self._t, self._values = np.append(self._t, t[1:]), np.append(self._values, values[1:])
        self._whole = np.append(self._whole, block[1:])
        earlier = t - self._window_s
        mean = (block - integral_at(self._t, self._values, self._whole, earlier)) / self._window_s
        used = max(0, int(np.searchsorted(self._t, earlier[-1])) - 1)
        self._t, self._values, self._whole = self._t[used:], self._values[used:], self._whole[used:]
        return np.asarray(mean)
