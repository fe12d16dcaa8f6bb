"""The time constant by the 63 % rule, step by step, as in the thesis (section 2.2, figure 2-5).

Steps count that begin on the curve they follow (the one before went the same way) and end on it, not at a stop, that
are clear of the noise and of the rate limit, and whose dwell is long enough to show the end. What the converter's lag
adds is taken out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from control.characterize import STOP_SHARE, Dwells, Settling, at_rest, find_dwells
from control.identify_interval import Interval
from control.identify_readings import fast_noise
from logs.recording import FloatArray, Recording

SHARE = 1.0 - math.exp(-1.0)
NOISES = 15.0  # a step must be so many times larger than the noise
WINDOW = (0.15, 0.6)  # the part of the step that is left: within it the rest falls exponentially
FEWEST_STEPS = 6  # of fewer not even the least and the largest hold the median in 95 of 100 cases
# Where a step ends is read so many time constants after it at the latest. A converter is never quite still, and a stem
# in a play follows the highest pressure yet and does not come back: what it creeps later is not the step's.
LATEST_TAUS = 4.5
BEFORE_TAUS = 0.3  # the readings just before a step, averaged: where it begins, settled or not


@dataclass(frozen=True, slots=True)
class StepTimes:
    """`raw_s` are the times from the command's jump to 63 % of the stem's step; `tau_s` the time constant, if known."""

    raw_s: FloatArray
    tau_s: Interval | None


def time_constant_63(
    recordings: list[Recording], settling: Settling, travel: float, lag_doubt_s: float = 0.0
) -> StepTimes:
    """The median over all steps that count, with an interval from their order statistics.

    `settling` is what the fit says, needed to know which dwells are long enough and where they end. `lag_doubt_s`: how
    far the converter's lag, which is taken out, may be off, half of a 95 % interval.
    """
    ep_tau_s = settling.delay_s
    found: list[float] = []
    for recording in recordings:
        dwells = find_dwells(recording)
        found += _times(recording, dwells, settling, travel)
    raw_s = np.array(found)
    if raw_s.size < FEWEST_STEPS:
        return StepTimes(raw_s, None)
    each = np.sort([without_lag(t, ep_tau_s) for t in raw_s])
    reach = 1.96 * math.sqrt(each.size) / 2.0
    low = max(0, math.floor(each.size / 2.0 - reach))
    high = min(each.size - 1, math.ceil(each.size / 2.0 + reach))
    middle = float(np.median(each))
    below, above = (float(np.hypot(each[end] - middle, lag_doubt_s)) for end in (low, high))
    return StepTimes(raw_s, Interval(middle, middle - below, middle + above))


def _times(recording: Recording, dwells: Dwells, settling: Settling, travel: float) -> list[float]:
    tau_s, ep_tau_s = settling.tau_s, settling.delay_s
    least = max(NOISES * fast_noise(recording.position), 0.01 * travel)
    largest = min(0.6 * settling.rate_limit * tau_s, 0.5 * travel)
    ends = _ends(recording, dwells, settling)
    # The play is at a stop before the converter has come to rest, and leaves it after the converter has set out.
    inside = (ends > STOP_SHARE * travel) & (ends < (1.0 - STOP_SHARE) * travel)
    times = []
    for i in range(2, dwells.command.size):
        if not inside[i - 1 : i + 1].all():
            continue
        start_s = dwells.start_s[i]
        before = (recording.time_s > start_s - BEFORE_TAUS * tau_s) & (recording.time_s <= start_s)
        if not np.isfinite(recording.position[before]).any():
            continue
        step = ends[i] - float(np.nanmean(recording.position[before]))
        on_curve = dwells.moved[i - 1] * step > 0.0 and abs(dwells.moved[i - 1]) > 0.25 * least
        if not on_curve or not least < abs(step) < largest:
            continue
        if dwells.tail_s[i, 1] < 4.0 * tau_s or dwells.tail_s[i - 1, 1] < 4.0 * tau_s:
            continue
        rows = (recording.time_s >= start_s) & (recording.time_s <= start_s + dwells.tail_s[i, 1])
        elapsed_s = recording.time_s[rows] - start_s
        left = (ends[i] - recording.position[rows]) / step
        # Rows are chosen by when they should lie there: choosing them by their noisy value would bend the line.
        expected = np.exp(-np.maximum(elapsed_s - ep_tau_s, 0.0) / tau_s)
        near = (expected > WINDOW[0]) & (expected < WINDOW[1]) & (left > 0.0)
        crossed = crossing_s(elapsed_s[near], left[near])
        if crossed is not None:
            times.append(crossed)
    return times


def _ends(recording: Recording, dwells: Dwells, settling: Settling) -> FloatArray:
    """Where the stem of each dwell comes to rest, shape (m,); NaN where too few rows tell it within `LATEST_TAUS`.

    Rows that lie far apart leave dwells without an end, so the two are paired by when they begin.
    """
    begun = find_dwells(recording, settling.delay_s + LATEST_TAUS * settling.tau_s)
    known = dict(zip(begun.start_s.tolist(), at_rest(begun, settling).tolist(), strict=True))
    return np.array([known.get(start_s, np.nan) for start_s in dwells.start_s.tolist()])


def crossing_s(elapsed_s: FloatArray, left: FloatArray) -> float | None:
    """When the share of a step that is left, `left`, falls to 1/e, by a line through its logarithm; None if never."""
    if elapsed_s.size < 2 or np.ptp(elapsed_s) <= 0.0:
        return None
    slope, start = np.polyfit(elapsed_s, np.log(left), 1)
    crossed = (-1.0 - start) / slope if slope < 0.0 else -1.0
    return float(crossed) if crossed > 0.0 else None


def together(tau_s: float, ep_tau_s: float) -> float:
    """When a lag of `tau_s` behind a shorter one of `ep_tau_s` reaches 63 % of a step [s]; inverse of `without_lag`."""
    from scipy.optimize import brentq

    return float(brentq(lambda time_s: _left(time_s, tau_s, ep_tau_s) - (1.0 - SHARE), tau_s, tau_s + 3.0 * ep_tau_s))


def without_lag(time_63_s: float, ep_tau_s: float) -> float:
    """The time constant of a lag that, behind one of `ep_tau_s`, reaches 63 % of a step after `time_63_s`."""
    from scipy.optimize import brentq

    if ep_tau_s <= 1e-6 * time_63_s or time_63_s <= 2.2 * ep_tau_s:
        return time_63_s
    found = brentq(lambda tau_s: _left(time_63_s, tau_s, ep_tau_s) - (1.0 - SHARE), 1.0001 * ep_tau_s, time_63_s)
    return float(found)


def _left(time_s: float, tau_s: float, ep_tau_s: float) -> float:
    """The share of a step that two lags in a row have left to go."""
    slow = tau_s * math.exp(-time_s / tau_s) - ep_tau_s * math.exp(-time_s / ep_tau_s)
    return slow / (tau_s - ep_tau_s)
