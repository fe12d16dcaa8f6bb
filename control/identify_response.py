"""The converter's lag as command and pressure tell it: the best response, its interval, and what else would do.

Between rows that are far apart a short lag leaves next to no trace: of one of 0.3 s less than 0.2 % of a step is left
after 2 s. What the readings do not contradict is then a whole range of lags, and every number that is fitted behind the
converter has to allow for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from control.identify_interval import Interval, intervals, memory_rows
from control.identify_model import Grid, lagged
from logs.recording import FloatArray

TAU_RANGE_S = (0.005, 60.0)
LONGEST_S = 1.0  # lag of a converter whose pressure does not say that it is longer
SURE_95 = 1.96


@dataclass(frozen=True, slots=True)
class Shape:
    """The best gain, zero and start for a time constant; `rows` is the response at the rows."""

    tau_s: float
    cost: float
    gain: float
    zero: float
    start: float
    rows: FloatArray

    def fine(self, grid: Grid, command: FloatArray) -> FloatArray:
        """The response on the fine grid."""
        fade = np.exp(-(grid.fine_time_s - grid.time_s[0]) / max(self.tau_s, 1e-6))
        response = lagged(grid, command, self.tau_s, float(command[0]))
        return np.asarray(self.gain * response + self.zero + self.start * fade)


def project(grid: Grid, command: FloatArray, pressure: FloatArray, good: np.ndarray, tau_s: float) -> Shape:
    """The best shape for one time constant, by least squares that a few false readings cannot pull."""
    rows = lagged(grid, command, tau_s, float(command[0]))[grid.first]
    middle = float(np.mean(rows[good]))
    columns = [rows - middle, np.ones_like(rows), np.exp(-(grid.time_s - grid.time_s[0]) / max(tau_s, 1e-6))]
    if np.ptp(rows[good]) < 1e-9:
        columns[0] = np.zeros_like(rows)
    basis = np.stack(columns)
    weight = good.astype(np.float64)
    target = np.where(good, pressure, 0.0)
    for _ in range(3):
        weighted = basis * weight
        # Plain loops: the threads of a linear algebra library cost more than three columns are worth.
        normal, right = np.einsum("ik,jk->ij", weighted, basis), np.einsum("ik,k->i", weighted, target)
        found = np.linalg.lstsq(normal, right, rcond=1e-12)[0]
        fitted = np.einsum("i,ik->k", found, basis)
        rest = np.where(good, pressure - fitted, 0.0)
        limit = 3.0 * 1.4826 * float(np.median(np.abs(rest[good]))) + 1e-12
        weight = good * np.minimum(1.0, limit / np.maximum(np.abs(rest), 1e-12))
    gain = float(found[0]) if columns[0].any() else 1.0
    zero = float(found[1]) - gain * middle
    return Shape(tau_s, float(np.sum(weight * rest**2)), gain, zero, float(found[2]), np.asarray(fitted))


def interval_of(grid: Grid, command: FloatArray, pressure: FloatArray, good: np.ndarray, log_tau: float) -> Interval:
    step = 1e-3
    at, above, below = (project(grid, command, pressure, good, float(np.exp(log_tau + z))) for z in (0.0, step, -step))
    slope = (above.rows - below.rows)[good] / (2.0 * step)
    rest = (pressure - at.rows)[good]
    limit = 3.0 * 1.4826 * float(np.median(np.abs(rest))) + 1e-12
    found = intervals(np.array([log_tau]), slope[:, None], np.clip(rest, -limit, limit))[0]
    tau_s = float(np.exp(log_tau))
    return Interval(tau_s, tau_s * float(np.exp(found.low - log_tau)), tau_s * float(np.exp(found.high - log_tau)))


def told(
    grid: Grid, command: FloatArray, pressure: FloatArray, good: np.ndarray, best: Shape, default_tau_s: float
) -> tuple[Interval | None, float, float]:
    """The lag's interval, if the record tells it; the lag to use; how far that may be off, half of a 95 % interval.

    A lag shorter than the sampling period is no straight line in its logarithm: its ends are looked for.
    """
    interval = interval_of(grid, command, pressure, good, float(np.log(best.tau_s)))
    straight = float(np.median(np.diff(grid.time_s))) <= best.tau_s
    if straight and interval.half_width <= 0.5 * interval.value:
        return interval, best.tau_s, interval.half_width
    ends = ends_of(grid, command, pressure, good, best)
    if not straight:
        interval = Interval(best.tau_s, min(interval.low, ends[0]), max(interval.high, ends[1]))
        if interval.half_width <= 0.5 * interval.value:
            return interval, best.tau_s, interval.half_width
    high = min(ends[1], max(LONGEST_S, best.tau_s, default_tau_s))
    lag_s = float(np.clip(default_tau_s, ends[0], high))
    return None, lag_s, max(high - lag_s, lag_s - ends[0])


def ends_of(
    grid: Grid, command: FloatArray, pressure: FloatArray, good: np.ndarray, best: Shape
) -> tuple[float, float]:
    """The shortest and the longest lag that the readings do not contradict at 95 % (likelihood ratio)."""
    rest = (pressure - best.rows)[good]
    worth = best.cost * (1.0 + SURE_95**2 * memory_rows(rest) / max(1, rest.size))

    def end(far: float) -> float:
        inside, outside = float(np.log(best.tau_s)), float(np.log(far))
        if project(grid, command, pressure, good, far).cost <= worth:
            return far
        for _ in range(12):
            middle = 0.5 * (inside + outside)
            if project(grid, command, pressure, good, float(np.exp(middle))).cost <= worth:
                inside = middle
            else:
                outside = middle
        return float(np.exp(inside))

    low = end(TAU_RANGE_S[0])
    return (0.0 if low == TAU_RANGE_S[0] else low), end(TAU_RANGE_S[1])
