"""Stick-slip: the stem slows down and starts again, time after time, while the pressure goes on one way.

A play followed by lags moves evenly once a ramp has picked it up; a curved spring or a rough spot changes its speed
once or twice. Speed that swings between far below and far above its mean many times on one ramp of measured pressure
is an event that none of them makes; point-wise errors do not show it once the jumps are as small as the noise.
Source: Choudhury, Thornhill & Shah, "Modelling valve stiction", Control Engineering Practice 13, 2005 (deadband,
stickband, slip jump).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from logs.recording import FloatArray
from twin.diagnosis import Estimate
from twin.events.evidence import Evidence, nothing
from twin.noise.model import poisson_tail
from twin.where.regime import speed_sigma

IntArray = npt.NDArray[np.int64]

_BELL_S = 0.4
_CLEAR = 4.0  # sigmas of speed noise, and
_SWING = 0.35  # of the mean speed: beyond both, the speed is above or below its mean
_USUAL = 0.5  # swings per ramp that other effects make


@dataclass(frozen=True, slots=True)
class _Swing:
    """One slow-down and new start: rows of the slow part, pressure and stem travel from start to start."""

    slow: int
    start: int
    build_up: float
    jump: float


def stick_slip(
    time_s: FloatArray,
    reading: FloatArray,
    pressure: FloatArray | None,
    noise_sigma: float,
    correlation_samples: float = 1.0,
) -> Evidence:
    """Evidence for `stiction` from slow ramps; `pressure` is measured, its own noise is filtered here.

    Estimates: `build_up` (pressure from one start to the next, in its unit), `jump` (stem travel in between), `dwell`
    (time below the mean speed) [s], `speed_spread` on the ramps (deviation over mean; small for even motion).
    """
    if pressure is None:
        return nothing("stiction", "without measured pressure a stop of the stem may be a stop of the pressure")
    if time_s.size < 100 or noise_sigma <= 0.0:
        return nothing("stiction", "too few readings, or no noise floor")
    period = float(np.median(np.diff(time_s)))
    bell = max(_BELL_S / period, 1.0)
    smooth = gaussian_filter1d(_filled(reading), bell, mode="nearest")
    speed = np.gradient(smooth, time_s)
    drive = np.gradient(gaussian_filter1d(_filled(pressure), bell, mode="nearest"), time_s)
    speed_noise = speed_sigma(noise_sigma, period, bell, correlation_samples)
    swings: list[_Swing] = []
    runs = 0
    shape: list[FloatArray] = []
    for start, stop in _ramps(drive, time_s):
        moving = _moving(speed[start:stop] * np.sign(pressure_change(pressure, start, stop)), speed_noise)
        if moving is None:
            continue
        runs += 1
        v = np.abs(speed[start:stop][moving])
        shape.append(v / v.mean() - 1.0)
        swings += _swings(v, start + moving.start, smooth, pressure, speed_noise)
    if runs == 0:
        return nothing("stiction", "no slow ramp of pressure moves the stem: stick-slip could not show")
    return _evidence(swings, runs, time_s, np.concatenate(shape))


def pressure_change(pressure: FloatArray, start: int, stop: int) -> float:
    """Change of pressure over the rows, from the medians of their ends; not a number where one was not read."""
    ends = max(1, min(10, (stop - start) // 2))
    first, last = pressure[start : start + ends], pressure[stop - ends : stop]
    if not (np.isfinite(first).any() and np.isfinite(last).any()):
        return float("nan")
    return float(np.nanmedian(last) - np.nanmedian(first))


def _evidence(swings: list[_Swing], runs: int, time_s: FloatArray, shape: FloatArray) -> Evidence:
    expected = _USUAL * runs
    spread = float(shape.std())
    estimates = {"speed_spread": Estimate(spread, (spread, spread))}
    count = len(swings)
    note = f"{count} swings of the speed on {runs} ramps"
    if count <= expected:
        return Evidence("stiction", 0.0, 1.0, estimates, note)
    for label, unit, values in (
        ("build_up", "", [abs(s.build_up) for s in swings]),
        ("jump", "", [abs(s.jump) for s in swings]),
        ("dwell", "s", [float(time_s[s.start] - time_s[s.slow]) for s in swings]),
    ):
        estimates[label] = _median(np.array(values), unit)
    ratio = float(count * np.log(count / expected) - (count - expected))
    return Evidence("stiction", ratio, poisson_tail(count, expected), estimates, note)


def _ramps(drive: FloatArray, time_s: FloatArray) -> list[tuple[int, int]]:
    """Stretches of at least 10 s where the pressure goes one way at a rate between half and twice its median there."""
    floor = 0.2 * float(np.median(np.abs(drive)))
    sign = np.where(np.abs(drive) > floor, np.sign(drive), 0.0)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(sign)) + 1, [sign.size]])
    found = []
    for start, stop in pairwise(edges):
        if sign[start] == 0 or time_s[stop - 1] - time_s[start] < 10.0:
            continue
        rate = np.abs(drive[start:stop])
        if np.mean(np.abs(rate / np.median(rate) - 1.0) < 0.5) > 0.8:
            found.append((int(start), int(stop)))
    return found


def _moving(v: FloatArray, speed_noise: float) -> slice | None:
    """Rows from the first to the last clear motion along the ramp; None if the stem moves too slowly to tell."""
    clear = np.flatnonzero(v > _CLEAR * speed_noise)
    if clear.size == 0:
        return None
    rows = slice(int(clear[0]), int(clear[-1]) + 1)
    return rows if float(v[rows].mean()) > 1.5 * _CLEAR * speed_noise else None


def _swings(v: FloatArray, first: int, smooth: FloatArray, pressure: FloatArray, speed_noise: float) -> list[_Swing]:
    """Swings fast - slow - fast of the speed `v`, whose first row is row `first` of the recording."""
    reach = max(_CLEAR * speed_noise, _SWING * float(v.mean()))
    state = np.where(v > v.mean() + reach, 1, np.where(v < v.mean() - reach, -1, 0))
    said = np.flatnonzero(state)
    turns = said[np.flatnonzero(np.diff(state[said], prepend=0))]
    fast = [int(row) for row in turns if state[row] > 0]
    slow = [int(row) for row in turns if state[row] < 0]
    swings = []
    for one, two in pairwise(fast):
        middle = next(row for row in slow if one < row < two)
        a, b = first + one, first + two
        swings.append(_Swing(first + middle, b, float(pressure[b] - pressure[a]), float(smooth[b] - smooth[a])))
    return swings


def _median(values: FloatArray, unit: str) -> Estimate:
    """Median with a 95 % interval of order statistics."""
    ordered = np.sort(values)
    reach = 0.98 * np.sqrt(ordered.size)
    low = ordered[max(int(np.floor(ordered.size / 2 - reach)), 0)]
    high = ordered[min(int(np.ceil(ordered.size / 2 + reach)), ordered.size - 1)]
    return Estimate(float(np.median(ordered)), (float(low), float(high)), unit)


def _filled(signal: FloatArray) -> FloatArray:
    known = np.isfinite(signal)
    if known.all() or not known.any():
        return signal
    rows = np.arange(signal.size)
    return np.interp(rows, rows[known], signal[known])
