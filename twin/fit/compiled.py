"""What every fit does to whole columns of readings, compiled: one pass each, and other threads go on meanwhile."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.record.rows import Rows


@njit(cache=True, nogil=True, error_model="numpy")
def in_noise(measured: FloatArray, predicted: FloatArray, use: np.ndarray, sigma: float, half: float) -> FloatArray:
    """(measured - predicted) / sigma where `use`, else 0; all of shape (n,). Of an error only what exceeds `half`."""
    out = np.zeros(measured.size)
    for row in range(measured.size):
        if use[row]:
            error = measured[row] - predicted[row]
            if half > 0.0:
                error -= min(max(error, -half), half)
            out[row] = error / sigma
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def at_all_rows(few: FloatArray, rows: Rows, use: np.ndarray) -> FloatArray:
    """Columns known at some `rows` (ascending, the first is 0) at every row by straight lines, 0 where not `use`.

    `few` has a line for each of `rows`, and below them others, which stay below; shape (use.size + others, columns).
    """
    others, columns = few.shape[0] - rows.size, few.shape[1]
    out = np.zeros((columns, use.size + others))
    for k in range(columns):
        out[k, use.size :] = few[rows.size :, k]
        for i in range(rows.size):
            begin = rows[i]
            end = rows[i + 1] if i + 1 < rows.size else use.size
            slope = (few[i + 1, k] - few[i, k]) / (end - begin) if i + 1 < rows.size else 0.0
            for row in range(begin, end):
                if use[row]:
                    out[k, row] = slope * (row - begin) + few[i, k]
    return out.T
