"""Which way the stem moves and in which regime, row by row, steady against noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from logs.recording import FloatArray

IntArray = npt.NDArray[np.int64]

DIRECTIONS = ("closing", "opening", "still")
REGIMES = ("deadband", "moving", "reversal", "end_stop")
_BELL_S = 0.5  # standard deviation of the bell under which speed is taken
_LEAST = 1e-3  # of travel per second, or per row of a slow record: what is slower is called still
_START, _STOP = 4.0, 2.0  # sigmas of speed noise to start moving, and to go on


@dataclass(frozen=True, slots=True)
class Regimes:
    """Per row an index into `DIRECTIONS` and one into `REGIMES`; both int64, shape (n,)."""

    direction: IntArray
    regime: IntArray


def classify(
    time_s: FloatArray,
    reading: FloatArray,
    prediction: FloatArray,
    pressure: FloatArray,
    noise_sigma: float,
    travel: float,
    after_s: float = 2.0,
    correlation_samples: float = 1.0,
) -> Regimes:
    """Classes of every row; `pressure` is the smoothed measured one, or the model's where none was measured.

    closing, opening: the smoothed reading rises or falls faster than its noise and 0.1 % of travel per second (per row
    where rows are further apart).
    end_stop: still, with the reading or the prediction within 1 % of travel of an end.
    reversal: the stem coasts against the pressure's direction, or has moved for less than `after_s` the other way.
    deadband: still elsewhere. moving: all other motion.
    """
    period = float(np.median(np.diff(time_s))) if time_s.size > 1 else 1.0
    bell = max(_BELL_S / period, 1.0)
    smooth = gaussian_filter1d(_filled(reading), bell, mode="nearest")
    speed_noise = speed_sigma(noise_sigma, period, bell, correlation_samples)
    motion = _motion(np.gradient(smooth, time_s), speed_noise, _LEAST * travel / max(period, 1.0))
    pressure_motion = np.sign(np.gradient(gaussian_filter1d(_filled(pressure), bell, mode="nearest"), time_s))
    moving = motion != 0
    near = 0.01 * travel + 2.0 * noise_sigma / np.sqrt(bell)
    at_stop = np.zeros(motion.size, dtype=bool)
    for where in (smooth, prediction):
        at_stop |= (where <= near) | (where >= travel - near)
    turned = _turned(motion, time_s, after_s) | (moving & (motion * pressure_motion < 0))
    regime = np.where(moving, np.where(turned, 2, 1), np.where(at_stop, 3, 0))
    direction = np.where(motion > 0, 0, np.where(motion < 0, 1, 2))
    return Regimes(direction.astype(np.int64), regime.astype(np.int64))


def speed_sigma(noise_sigma: float, period_s: float, bell_rows: float, correlation_samples: float = 1.0) -> float:
    """Sigma of the speed [unit/s] taken under a bell of standard deviation `bell_rows` from such readings."""
    white = noise_sigma / (period_s * np.sqrt(4.0 * np.sqrt(np.pi)) * bell_rows**1.5)
    # memory raises slow noise, and no further than where the readings themselves set the speed
    return float(white * np.sqrt(min(correlation_samples, 2.0 * bell_rows)))


def _motion(speed: FloatArray, noise: float, least: float) -> IntArray:
    """-1, 0, 1: runs of one sign beyond the lower threshold that pass the higher one somewhere."""
    low, high = max(_STOP * noise, least), max(_START * noise, least)
    sign = np.where(np.abs(speed) > low, np.sign(speed), 0.0).astype(np.int64)
    starts = np.flatnonzero(np.diff(sign, prepend=sign[0] + 2))
    peak = np.maximum.reduceat(np.abs(speed), starts)
    lengths = np.diff(np.append(starts, sign.size))
    return np.where(np.repeat(peak > high, lengths), sign, 0)


def _turned(motion: IntArray, time_s: FloatArray, after_s: float) -> npt.NDArray[np.bool_]:
    """Rows of the first `after_s` of every motion against the one before it, rests in between or not."""
    starts = np.flatnonzero((motion != 0) & (np.diff(motion, prepend=0) != 0))
    against = starts[1:][motion[starts[1:]] == -motion[starts[:-1]]]
    stops = np.searchsorted(time_s, time_s[against] + after_s)
    change = np.zeros(motion.size + 1, dtype=np.int64)
    np.add.at(change, against, 1)
    np.add.at(change, stops, -1)
    turned = np.cumsum(change[:-1]) > 0
    return np.asarray(turned & (motion != 0))


def _filled(signal: FloatArray) -> FloatArray:
    known = np.isfinite(signal)
    if known.all() or not known.any():
        return signal
    rows = np.arange(signal.size)
    return np.interp(rows, rows[known], signal[known])
