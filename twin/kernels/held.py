"""What a converter's pressure says of the band within which it ignores commands: compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def held_squares(command: FloatArray, pressure: FloatArray, band: float) -> FloatArray:
    """Products of (p before, goal, 1, p), summed over the rows, shape (4, 4), where the goal holds still in a band.

    The pressure of a row is linear in the first three, with coefficients that are the same in all rows as long as these
    come evenly: a lag, behind any gain and zero. Rows without a pressure (NaN) are left out.
    """
    sums = np.zeros((4, 4))
    held = pressure[0]
    row = np.ones(4)
    for i in range(command.size):
        if not abs(command[i] - held) <= band:
            held = command[i]
        if i == 0 or np.isnan(pressure[i]) or np.isnan(pressure[i - 1]):
            continue
        row[0], row[1], row[3] = pressure[i - 1], held, pressure[i]
        for j in range(4):
            for k in range(j, 4):
                sums[j, k] += row[j] * row[k]
    return sums
