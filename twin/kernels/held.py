"""A converter that ignores commands within a band, and what its pressure says of the band: compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray

#: Of a band: a pressure that near a command is where that command was accepted, but for its noise.
_NEAR = 0.1


def accepted_before(command: float, band: float, start: float) -> float:
    """What stands, where a record begins, in a converter whose pressure is at `start` then, under a first command."""
    return command if abs(command - start) < _NEAR * band else start


@njit(cache=True, nogil=True, error_model="numpy")
def banded(values: FloatArray, band: float, hold: bool, start: float, out: FloatArray) -> None:
    """Fills `out` with `values` behind a band: `hold` jumps to the value once it is outside, else a play follows.

    What stands at `start` has seen the first value, which was in force before the first row (see `held_at_first`).
    """
    held = start
    out[0] = held
    for i in range(1, values.size):
        u = values[i]
        if not hold:
            held = max(u - band, min(u + band, held))
        elif abs(u - held) > band:
            held = u
        out[i] = held


def held_at_first(command: float, band: float, hold: bool, start: float) -> float:
    """What a converter with a band stands at when it has seen the first command of a record."""
    if not hold:
        return max(command - band, min(command + band, start))
    stands = accepted_before(command, band, start)
    return command if abs(command - stands) > band else stands


@njit(cache=True, nogil=True, error_model="numpy")
def held_squares(command: FloatArray, pressure: FloatArray, band: float) -> FloatArray:
    """Products of (p before, goal, 1, p), summed over the rows, shape (4, 4), where the goal holds still in a band.

    The pressure of a row is linear in the first three, with coefficients that are the same in all rows as long as these
    come evenly: a lag, behind any gain and zero. Rows without a pressure (NaN) are left out.
    """
    sums = np.zeros((4, 4))
    held = command[0] if abs(command[0] - pressure[0]) < _NEAR * band else pressure[0]
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
