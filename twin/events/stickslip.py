"""Stick-slip: the stem stops and starts again while the pressure goes on in one direction.

A play followed by lags moves on without a stop once a ramp has picked it up. A stop in the middle of a monotone ramp
of measured pressure is therefore an event that neither play nor lag nor a curved spring makes; point-wise errors do not
show it once the jumps are as small as the noise. Source: Choudhury, Thornhill & Shah, "Modelling valve stiction",
Control Engineering Practice 13, 2005 (deadband, stickband, slip jump).
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
_SHORTEST_S = 0.8
_MOVES, _RESTS = 4.0, 2.0  # sigmas of speed noise
_FALSE_PER_RUN = 0.02  # stops per ramp that noise alone makes; set on ramps without stick-slip


@dataclass(frozen=True, slots=True)
class _Stop:
    """A rest of the stem between two motions of one direction: rows, pressure built up in it, the jump that follows."""

    start: int
    stop: int
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

    Estimates: `build_up` (pressure gathered during a stop, in its unit), `jump` (stem travel after it), `dwell` [s],
    `speed_kurtosis` on the ramps (3 for even motion in noise).
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
    ramps = _ramps(drive, time_s)
    stops: list[_Stop] = []
    runs = 0
    shape: list[FloatArray] = []
    for start, stop in ramps:
        found, moved = _stops_in(slice(start, stop), smooth, speed, pressure, speed_noise, period)
        stops += found
        runs += moved
        if moved:
            shape.append(speed[start:stop] / float(np.mean(np.abs(speed[start:stop]))))
    if runs == 0:
        return nothing("stiction", "no slow ramp of pressure moves the stem: stick-slip could not show")
    return _evidence(stops, runs, time_s, np.concatenate(shape))


def _evidence(stops: list[_Stop], runs: int, time_s: FloatArray, shape: FloatArray) -> Evidence:
    expected = _FALSE_PER_RUN * runs
    centred = shape - shape.mean()
    kurtosis = float(np.mean(centred**4) / max(float(np.mean(centred**2)) ** 2, 1e-30))
    estimates = {"speed_kurtosis": Estimate(kurtosis, (kurtosis, kurtosis))}
    if not stops:
        return Evidence("stiction", 0.0, 1.0, estimates)
    for name, unit, values in (
        ("build_up", "", [abs(s.build_up) for s in stops]),
        ("jump", "", [abs(s.jump) for s in stops]),
        ("dwell", "s", [float(time_s[s.stop - 1] - time_s[s.start]) for s in stops]),
    ):
        estimates[name] = _median(np.array(values), unit)
    count = len(stops)
    ratio = max(0.0, count * np.log(count / expected) - (count - expected))
    return Evidence(
        "stiction", float(ratio), poisson_tail(count, expected), estimates, f"{count} stops on {runs} ramps"
    )


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


def _stops_in(
    rows: slice, smooth: FloatArray, speed: FloatArray, pressure: FloatArray, speed_noise: float, period_s: float
) -> tuple[list[_Stop], int]:
    """Stops on one ramp and whether the ramp moves the stem fast enough to see one."""
    v = speed[rows] * np.sign(pressure[rows.stop - 1] - pressure[rows.start])
    fast = float(np.mean(v[v > _RESTS * speed_noise])) if (v > _RESTS * speed_noise).any() else 0.0
    high, low = max(_MOVES * speed_noise, 0.3 * fast), max(_RESTS * speed_noise, 0.1 * fast)
    if fast < 1.5 * _MOVES * speed_noise:
        return [], 0
    moving = np.flatnonzero(v > high)
    still = v < low
    stops = []
    for start, stop in _true_runs(still):
        inside = moving.size and moving[0] < start and moving[-1] >= stop
        if inside and (stop - start) * period_s >= _SHORTEST_S:
            nxt = next((a for a, _ in _true_runs(still) if a >= stop), v.size - 1)
            a, b, c = rows.start + start, rows.start + stop, rows.start + nxt
            stops.append(_Stop(a, b, float(pressure[b - 1] - pressure[a]), float(smooth[c] - smooth[b - 1])))
    return stops, 1


def _true_runs(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


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
