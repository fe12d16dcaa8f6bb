"""The time constant by the 63 % rule, step by step, as in the thesis (section 2.2, figure 2-5).

Steps count that begin on the curve they follow (the one before went the same way), that are clear of the noise and of
the rate limit, and whose dwell is long enough to show the end. What the converter's lag adds is taken out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from control.characterize import Dwells, at_rest, find_dwells, reading_noise
from control.identify_interval import Interval
from logs.recording import FloatArray, Recording

SHARE = 1.0 - math.exp(-1.0)
NOISES = 15.0  # a step must be so many times larger than the noise
WINDOW = (0.15, 0.6)  # the part of the step that is left: within it the rest falls exponentially
FEWEST_STEPS = 3


@dataclass(frozen=True, slots=True)
class StepTimes:
    """`raw_s` are the times from the command's jump to 63 % of the stem's step; `tau_s` the time constant, if known."""

    raw_s: FloatArray
    tau_s: Interval | None


def time_constant_63(
    recordings: list[Recording], ep_tau_s: float, tau_s: float, rate_limit: float, travel: float
) -> StepTimes:
    """The median over all steps that count, with an interval from their order statistics.

    `tau_s` is the fitted value, needed to know which dwells are long enough and where they end.
    """
    found: list[float] = []
    for recording in recordings:
        dwells = find_dwells(recording)
        found += _times(recording, dwells, ep_tau_s, tau_s, min(0.6 * rate_limit * tau_s, 0.5 * travel))
    raw_s = np.array(found)
    if raw_s.size < FEWEST_STEPS:
        return StepTimes(raw_s, None)
    each = np.sort([without_lag(t, ep_tau_s) for t in raw_s])
    reach = 1.96 * math.sqrt(each.size) / 2.0
    low = max(0, math.floor(each.size / 2.0 - reach))
    high = min(each.size - 1, math.ceil(each.size / 2.0 + reach))
    return StepTimes(raw_s, Interval(float(np.median(each)), float(each[low]), float(each[high])))


def _times(recording: Recording, dwells: Dwells, ep_tau_s: float, tau_s: float, largest: float) -> list[float]:
    noise = reading_noise(recording)
    ends = at_rest(dwells, tau_s, ep_tau_s)
    times = []
    for i in range(2, dwells.command.size):
        step = ends[i] - ends[i - 1]
        on_curve = dwells.moved[i - 1] * step > 0.0 and abs(dwells.moved[i - 1]) > 4.0 * noise
        if not on_curve or not NOISES * noise < abs(step) < largest:
            continue
        if dwells.tail_s[i, 1] < 4.0 * tau_s or dwells.tail_s[i - 1, 1] < 4.0 * tau_s:
            continue
        start_s = dwells.start_s[i]
        rows = (recording.time_s >= start_s) & (recording.time_s <= start_s + dwells.tail_s[i, 1])
        crossed = _crossing(recording.time_s[rows], (ends[i] - recording.position[rows]) / step)
        if crossed is not None and crossed > start_s:
            times.append(crossed - start_s)
    return times


def _crossing(time_s: FloatArray, left: FloatArray) -> float | None:
    """When the share of a step that is left, `left`, has fallen to 1/e, by a line through its logarithm."""
    near = (left > WINDOW[0]) & (left < WINDOW[1])
    if near.sum() < 2 or np.ptp(time_s[near]) <= 0.0:
        return None
    slope, start = np.polyfit(time_s[near] - time_s[0], np.log(left[near]), 1)
    return float(time_s[0] + (-1.0 - start) / slope) if slope < 0.0 else None


def without_lag(time_63_s: float, ep_tau_s: float) -> float:
    """The time constant of a lag that, behind one of `ep_tau_s`, reaches 63 % of a step after `time_63_s`."""
    from scipy.optimize import brentq

    if ep_tau_s <= 1e-6 * time_63_s or time_63_s <= 2.2 * ep_tau_s:
        return time_63_s

    def miss(tau_s: float) -> float:
        slow = tau_s * math.exp(-time_63_s / tau_s) - ep_tau_s * math.exp(-time_63_s / ep_tau_s)
        return 1.0 - slow / (tau_s - ep_tau_s) - SHARE

    return float(brentq(miss, 1.0001 * ep_tau_s, time_63_s))
