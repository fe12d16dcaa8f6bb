"""The design model as a fast function of its numbers, with separate slopes of the two curves, for identification only.

    p' = (u - p) / ep_tau
    w  = clip(max(k1 (p - a1), min(k2 (p - a2), w)), 0, travel)
    x' = clip((w - x) / tau, -rate, rate),   0 <= x <= travel

Every sampling interval is cut into equal sub-steps of at most `SUB_STEP_S`; within one, w is taken as linear and the
lag is solved exactly, which keeps the error below 0.02 % of travel at sampling periods up to 0.5 s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import numpy.typing as npt
from numba import njit

from logs.recording import FloatArray

IntArray = npt.NDArray[np.int64]

SUB_STEP_S = 0.025
MOST_SUB_STEPS = 400  # in a long gap; the valve is at rest by the end of it anyway
A1, A2, K1, K2, TAU, RATE, TRAVEL, EP = range(8)  # places in the vector of a fit's numbers


@dataclass(frozen=True, slots=True)
class Grid:
    """The sub-steps of a record: `first[i]` is the fine index of row i, `step_s[i]` the sub-step of interval i-1..i."""

    time_s: FloatArray
    first: IntArray
    step_s: FloatArray

    @property
    def n_fine(self) -> int:
        return int(self.first[-1]) + 1

    @property
    def fine_time_s(self) -> FloatArray:
        return np.interp(np.arange(self.n_fine), self.first, self.time_s)


def make_grid(time_s: FloatArray, sub_step_s: float = SUB_STEP_S) -> Grid:
    """Cuts the intervals between rows, shape (n,), into sub-steps."""
    gaps_s = np.diff(time_s)
    counts = np.clip(np.ceil(gaps_s / sub_step_s - 1e-9), 1, MOST_SUB_STEPS).astype(np.int64)
    first = np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(counts)))
    return Grid(np.ascontiguousarray(time_s), first, np.concatenate((np.zeros(1), gaps_s / counts)))


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Machine code that runs without the interpreter lock, kept on disk."""
    return cast(Callable[..., Any], njit(cache=True, nogil=True, error_model="numpy")(function))


@compiled
def _lag(step_s: FloatArray, first: IntArray, command: FloatArray, tau_s: float, start: float, out: FloatArray) -> None:
    out[0] = start
    p = start
    for i in range(1, first.size):
        decay = np.exp(-step_s[i] / tau_s) if tau_s > 1e-9 else 0.0
        for f in range(first[i - 1] + 1, first[i] + 1):
            p = command[f] + (p - command[f]) * decay
            out[f] = p


def held(grid: Grid, command: FloatArray) -> FloatArray:
    """`command[i]`, which holds over the interval up to row i, on the fine grid."""
    return np.repeat(command, np.diff(grid.first, prepend=-1))


def lagged_fine(grid: Grid, command: FloatArray, tau_s: float, start: float) -> FloatArray:
    """A command on the fine grid behind a first-order lag."""
    out = np.empty(grid.n_fine)
    _lag(grid.step_s, grid.first, command, tau_s, start, out)
    return out


def lagged(grid: Grid, command: FloatArray, tau_s: float, start: float) -> FloatArray:
    """The command at the rows behind a first-order lag, on the fine grid."""
    return lagged_fine(grid, held(grid, command), tau_s, start)


@compiled
def _valve(
    step_s: FloatArray,
    first: IntArray,
    pressure: FloatArray,
    v: FloatArray,
    x0: float,
    w0: float,
    x_out: FloatArray,
    w_out: FloatArray,
) -> None:
    a1, a2, k1, k2, tau, rate, travel = v[0], v[1], v[2], v[3], v[4], v[5], v[6]
    x = min(max(x0, 0.0), travel)
    w = min(max(k1 * (pressure[0] - a1), min(k2 * (pressure[0] - a2), w0), 0.0), travel)
    x_out[0] = x
    w_out[0] = w
    for i in range(1, first.size):
        h = step_s[i]
        decay = np.exp(-h / tau) if tau > 1e-9 else 0.0
        for f in range(first[i - 1] + 1, first[i] + 1):
            p = pressure[f]
            before = w
            w = min(max(k1 * (p - a1), min(k2 * (p - a2), w), 0.0), travel)
            slope_tau = (w - before) / h * tau
            moved = w - slope_tau + (x - before + slope_tau) * decay - x
            x = min(max(x + min(max(moved, -rate * h), rate * h), 0.0), travel)
        x_out[i] = x
        w_out[i] = w


def stem(grid: Grid, pressure: FloatArray, numbers: FloatArray, x0: float, w0: float) -> tuple[FloatArray, FloatArray]:
    """Stem position and play output at the rows, shape (n,), for a pressure on the fine grid.

    `numbers` begins with (a1, a2, k1, k2, tau, rate, travel); `x0`, `w0` are the stem and the play
    output at the first row.
    """
    n = grid.time_s.size
    x, w = np.empty(n), np.empty(n)
    _valve(grid.step_s, grid.first, pressure, numbers, x0, w0, x, w)
    return x, w
