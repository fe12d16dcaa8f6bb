"""First stage: the converter's lag from command to pressure, and a pressure that is fit to drive the play.

Raw readings must not drive it: every peak of the noise pushes the play a little further and nothing pulls it back.
The pressure handed on is the fitted response to the command plus what is left of the readings after a zero-phase
moving average, whose width is the one that best predicts readings it has not seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from control.identify_interval import Interval, covariance
from control.identify_model import Grid, lagged
from control.identify_readings import fast_noise
from control.identify_response import TAU_RANGE_S, Shape, project, told
from logs.recording import FloatArray

WIDTHS_S = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
BLIND_S = 0.5  # readings closer than this share their noise and do not count as unseen
TOLERANCE = 0.005  # of the span, by which a pressure may differ from its command; gauges of a bench are no better
SURE_SIGMAS = 4.0  # ... and of the standard error of that difference
DOUBTS = 24
PIECES = 8.0  # the noise is dealt anew in pieces of this part of the average's width


@dataclass(frozen=True, slots=True)
class PressureStage:
    """pressure = gain * lag(command) + zero. `tau_s` is None where the record does not tell; `lag_s` was used then.

    `doubt_s` is how far the lag may be off, half of a 95 % interval, and `later` what drives the play if it is more by
    that: between rows that are far apart a lag leaves next to no trace, and whatever is fitted behind it carries that.
    `off` is the largest difference between a command of the record and the pressure that it settles at, `off_sigma` its
    standard error, `span` the range of the commands, or half the highest of them where that is more.
    """

    tau_s: Interval | None
    lag_s: float
    doubt_s: float
    gain: float
    zero: float
    rms: float
    width_s: float
    doubts: FloatArray  # what the smoothed pressure may be off by, shape (DOUBTS, n): noise like that of the readings
    fine: FloatArray  # the pressure that drives the play, on the fine grid
    later: FloatArray
    commanded: FloatArray  # the pressure that the design model makes of the command alone, on the fine grid
    off: float
    off_sigma: float
    span: float

    @property
    def is_calibrated(self) -> bool:
        """Whether the transmitter agrees with the commands, of which the design model knows nothing else."""
        return self.off <= max(TOLERANCE * self.span, SURE_SIGMAS * self.off_sigma)


def fit_pressure(grid: Grid, command: FloatArray, pressure: FloatArray, default_tau_s: float) -> PressureStage:
    """Fits the lag to readings, shape (n,), NaN where missing; keeps `default_tau_s` where it cannot be told."""
    good = np.isfinite(pressure)
    interval, lag_s, doubt_s, shape = _lag(grid, command, pressure, good, default_tau_s)
    rest = np.where(good, pressure - shape.rows, 0.0)
    width_s = _best_width_s(grid.time_s, rest, good) if good.sum() > 20 else 0.0
    correction = moving_average(grid.time_s, rest, good, width_s)
    later = project(grid, command, pressure, good, lag_s + doubt_s)
    commanded = lagged(grid, command, shape.tau_s, float(command[0]))
    off, off_sigma = _off(commanded[grid.first][good], command, shape, rest[good])
    return PressureStage(
        tau_s=interval,
        lag_s=lag_s,
        doubt_s=doubt_s,
        gain=shape.gain,
        zero=shape.zero,
        rms=float(np.sqrt(np.mean(rest[good] ** 2))),
        width_s=width_s,
        doubts=_doubts(grid.time_s, np.where(good, rest - correction, 0.0), good, width_s),
        fine=_driving(grid, command, pressure, good, shape, width_s),
        later=_driving(grid, command, pressure, good, later, width_s),
        commanded=commanded,
        off=off,
        off_sigma=off_sigma,
        span=float(max(np.ptp(command), 0.5 * np.max(np.abs(command)))),
    )


def _lag(
    grid: Grid, command: FloatArray, pressure: FloatArray, good: np.ndarray, default_tau_s: float
) -> tuple[Interval | None, float, float, Shape]:
    """The lag's interval, if it is told; the lag to use, how far that may be off at 95 %, and the response with it."""
    from scipy.optimize import minimize_scalar

    if not np.ptp(command[good]) > 20.0 * fast_noise(pressure[good]):
        return None, default_tau_s, 0.0, project(grid, command, pressure, good, default_tau_s)
    coarse = np.linspace(np.log(TAU_RANGE_S[0]), np.log(TAU_RANGE_S[1]), 24)
    best = coarse[int(np.argmin([project(grid, command, pressure, good, np.exp(z)).cost for z in coarse]))]
    step = coarse[1] - coarse[0]
    found = minimize_scalar(
        lambda z: project(grid, command, pressure, good, np.exp(z)).cost,
        bounds=(best - step, best + step),
        method="bounded",
        options={"xatol": 1e-5},
    )
    shape = project(grid, command, pressure, good, float(np.exp(float(found.x))))
    interval, lag_s, doubt_s = told(grid, command, pressure, good, shape, default_tau_s)
    return interval, lag_s, doubt_s, shape if interval else project(grid, command, pressure, good, lag_s)


def _driving(
    grid: Grid, command: FloatArray, pressure: FloatArray, good: np.ndarray, shape: Shape, width_s: float
) -> FloatArray:
    """The response and what the smoothed readings add to it, on the fine grid."""
    correction = moving_average(grid.time_s, np.where(good, pressure - shape.rows, 0.0), good, width_s)
    return shape.fine(grid, command) + np.interp(np.arange(grid.n_fine), grid.first, correction)


def _off(response: FloatArray, command: FloatArray, shape: Shape, rest: FloatArray) -> tuple[float, float]:
    """How far the settled pressure is from the command, at the end of the commands where it is further; its sigma."""
    if np.ptp(response) < 1e-9:
        return 0.0, 0.0
    middle = float(np.mean(response))
    limit = 3.0 * 1.4826 * float(np.median(np.abs(rest))) + 1e-12
    jacobian = np.column_stack((response - middle, np.ones_like(response)))
    spread, _ = covariance(jacobian, np.clip(rest, -limit, limit))
    ends = np.array([np.min(command), np.max(command)])
    off = np.abs(shape.gain * ends + shape.zero - ends)
    end = int(np.argmax(off))
    at = np.array([ends[end] - middle, 1.0])
    return float(off[end]), float(np.sqrt(at @ spread @ at))


def _doubts(time_s: FloatArray, noise: FloatArray, good: np.ndarray, width_s: float) -> FloatArray:
    """The readings' own noise, in pieces of random order and sign, smoothed like the readings.

    `noise` has lost its own moving average. Smoothed again as it is, it would keep a sixth of the variance that the
    average of noise has: sum (H - H H)^2 for a box H of N rows is 1/(6 N), not 1/N. Pieces much shorter than the box
    lose hardly anything, and keep the colour of a noise that is shorter than they are.
    """
    known = noise[good]
    period_s = max(float(np.median(np.diff(time_s))), 1e-9)
    rows = int(np.clip(width_s / PIECES / period_s, 1, max(1, known.size // 4)))
    pieces = np.array_split(known, max(1, known.size // rows))
    chance = np.random.default_rng(0)  # the same record has the same intervals
    found = []
    for _ in range(DOUBTS):
        dealt = np.zeros(noise.size)
        signs = chance.choice((1.0, -1.0), len(pieces))
        dealt[good] = np.concatenate([signs[i] * pieces[i] for i in chance.permutation(len(pieces))])
        found.append(moving_average(time_s, dealt, good, width_s))
    return np.array(found)


def moving_average(time_s: FloatArray, values: FloatArray, good: np.ndarray, width_s: float) -> FloatArray:
    """Mean of the good values within +-width/2 of each row; zero phase, shortened at the ends and across gaps."""
    total, count = _sums(time_s, values, good, 0.5 * width_s)
    return np.divide(total, count, out=np.zeros_like(total), where=count > 0)


def _sums(time_s: FloatArray, values: FloatArray, good: np.ndarray, reach_s: float) -> tuple[FloatArray, FloatArray]:
    sums = np.concatenate((np.zeros(1), np.cumsum(np.where(good, values, 0.0))))
    counts = np.concatenate((np.zeros(1), np.cumsum(good.astype(np.float64))))
    low = np.searchsorted(time_s, time_s - reach_s - 1e-9)
    high = np.searchsorted(time_s, time_s + reach_s + 1e-9)
    return sums[high] - sums[low], counts[high] - counts[low]


def _best_width_s(time_s: FloatArray, rest: FloatArray, good: np.ndarray) -> float:
    """The width whose average, without the readings next to it, predicts a reading best; wider on a tie."""
    blind, blind_count = _sums(time_s, rest, good, BLIND_S)
    best, best_cost = WIDTHS_S[-1], np.inf
    for width_s in reversed(WIDTHS_S):
        total, count = _sums(time_s, rest, good, 0.5 * width_s + BLIND_S)
        seen = good & (count - blind_count >= 2)
        if seen.sum() < 0.5 * good.sum():
            continue
        guess = (total - blind)[seen] / (count - blind_count)[seen]
        cost = float(np.mean(np.minimum(np.abs(rest[seen] - guess), 5.0 * (np.std(rest[good]) + 1e-12)) ** 2))
        if cost < 0.995 * best_cost:
            best, best_cost = width_s, cost
    return best
