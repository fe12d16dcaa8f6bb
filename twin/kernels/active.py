"""Whether something is there at all: compiled, because it is asked a dozen times for each simulation."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def acts(c: FloatArray, places: np.ndarray) -> bool:
    """Whether one of the coefficients at the `places` is not 0."""
    for place in places:  # noqa: SIM110 - numba compiles no generator
        if c[place] != 0.0:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def same(values: FloatArray) -> bool:
    """Whether all values are the first."""
    for value in values:  # noqa: SIM110 - numba compiles no generator
        if value != values[0]:
            return False
    return True
