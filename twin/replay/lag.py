"""A first-order lag that carries its state from one row to the next, on top of the compiled pass."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.lag import lag_pass

_NONE_S = 1e-9


class Lag:
    """Feeds blocks of fine points, each beginning with the last point of the block before, through one lag.

    Exact for input linear within a fine step, as the pass is: the pass starts at rest on its first value, and the
    state that was not at rest decays on top of it.
    """

    __slots__ = ("_state", "_tau_s", "ahead")

    def __init__(self, tau_s: float) -> None:
        self._tau_s = tau_s
        self._state: float | None = None
        self.ahead = 0.0  # of its first value, at the first point

    def follow(self, time_s: FloatArray, offsets: np.ndarray, values: FloatArray) -> FloatArray:
        """The lagged block, shape of `values`; `time_s` (2,) are its ends, `offsets` (0, steps)."""
        if self._tau_s <= _NONE_S:
            return values
        out = np.empty_like(values)
        lag_pass(time_s, offsets, values, self._tau_s, out)
        if self._state is None:
            self._state = float(values[0]) + self.ahead
        if self._state != values[0]:
            step_s = (time_s[1] - time_s[0]) / offsets[1]
            out += (self._state - values[0]) * np.exp(-step_s / self._tau_s * np.arange(values.size))
        self._state = float(out[-1])
        return out
