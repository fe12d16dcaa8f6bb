"""Stale samples: readings that repeat exactly while the stem moves or the noise should change them.

Two neighbouring readings of a lattice of step q are equal by chance with probability E max(0, 1 - |D| / q), where D is
the motion in between plus the difference of two noises. A held reading is equal whatever D is.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr
from scipy.stats import binomtest, chi2

from logs.recording import FloatArray
from twin.diagnosis import Estimate
from twin.events.clock import clock_of
from twin.events.evidence import Evidence, nothing

_MOST = 30_000  # pairs: more change nothing but the time
_TINY = 1e-7
_LOOK_S = 1.5  # how far to look for the motion, more than any refresh period to be found
_REFINED = 30
_MOVING = 0.05  # chance of being equal, below which a repeat is a held reading
_SPREADS = (0.0, *np.geomspace(0.03, 3.0, 40))  # noise differences tried, in given sigmas


def stale_samples(
    time_s: FloatArray, reading: FloatArray, noise_sigma: float, step: float | None, effect: str = "stale_samples"
) -> Evidence:
    """Evidence that the reading is refreshed more slowly than polled; `step` is its lattice spacing, if any.

    Estimates: `refresh_period` [s], `hold_fraction` (share of polls that found nothing new), `regularity` (1 for an
    even refresh, about 0 for holds at random, which are lost replies rather than a slow refresh), `again` (share of the
    repeats in motion that the next row repeats once more: the hold fraction for holds at random, none for a clock
    that is nearly as fast as the polls).
    """
    known = np.isfinite(reading)
    t, y = time_s[known], reading[known]
    if y.size < 50:
        return nothing(effect, "fewer than 50 readings")
    if np.ptp(y) == 0.0:
        return nothing(effect, "the reading never changes")
    period = float(np.median(np.diff(t)))
    rows = np.arange(0, y.size - 1)[:: max(1, y.size // _MOST)]
    same = (y[rows + 1] == y[rows]).astype(np.float64)
    motion = _motion(y, max(5, round(_LOOK_S / period)))[rows]
    null, held, chance, hold = _best(same, motion, noise_sigma, step)
    ratio = max(0.0, held - null)
    error = float(np.sqrt(max(hold * (1.0 - hold), 1e-6) / max(1.0, float(np.sum(1.0 - chance)))))
    low, high = max(hold - 1.96 * error, 0.0), min(hold + 1.96 * error, 0.999)
    estimates = {
        "refresh_period": _period(time_s, reading, period, (hold, low, high)),
        "hold_fraction": Estimate(hold, (low, high)),
        "regularity": Estimate(*_regularity(y)),
        "again": _again(y, rows[(same > 0.0) & (chance < _MOVING)]),
    }
    return Evidence(effect, ratio, float(chi2.sf(2.0 * ratio, 1)) / 2.0 if ratio > 0 else 1.0, estimates)


def _period(time_s: FloatArray, reading: FloatArray, row_s: float, hold: tuple[float, float, float]) -> Estimate:
    """Time between refreshes [s]: by the converter's own clock, else from the share of rows held (value, interval)."""
    clock = clock_of(time_s, reading)
    if clock is None:
        most = 1.0 - row_s / max(float(time_s[-1] - time_s[0]), 2.0 * row_s)  # longer than the record is not seen
        value, low, high = (row_s / (1.0 - min(share, most)) for share in hold)
        return Estimate(value, (low, high), "s")
    # over the record the clock may go wrong by the room that it leaves, once
    off_s = clock.slack_s * clock.period_s / max(float(time_s[-1] - time_s[0]), clock.period_s)
    return Estimate(clock.period_s, (clock.period_s - off_s, clock.period_s + off_s), "s")


def chance_equal(motion: FloatArray, spread: float, step: float | None) -> FloatArray:
    """Probability that two readings `motion` apart are equal, for noise differences of standard deviation `spread`."""
    if not step:
        return np.full(motion.shape, _TINY)
    parts = [_ramp(motion + shift, spread) for shift in (step, 0.0, -step)]
    return np.clip((parts[0] - 2.0 * parts[1] + parts[2]) / step, _TINY, 1.0 - _TINY)


def _ramp(x: FloatArray, spread: float) -> FloatArray:
    """Mean of max(0, x + spread z) for a standard normal z."""
    if spread <= 0.0:
        return np.maximum(x, 0.0)
    z = x / spread
    return np.asarray(spread * np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi) + x * ndtr(z))


def _motion(y: FloatArray, width: int) -> FloatArray:
    """Motion between readings i and i+1: the lesser of the mean motions before and after, 0 where they disagree.

    A slope taken across both sides would smear a motion over the rest beside it, and rests are equal for good reasons.
    """
    ends = np.concatenate([np.full(width, y[0]), y, np.full(width, y[-1])])
    before = (ends[width:-width] - ends[: -2 * width])[:-1] / width
    after = (ends[2 * width :] - ends[width:-width])[1:] / width
    return np.where(before * after > 0.0, np.sign(before) * np.minimum(np.abs(before), np.abs(after)), 0.0)


def _best(
    same: FloatArray, motion: FloatArray, sigma: float, step: float | None
) -> tuple[float, float, FloatArray, float]:
    """Best log-likelihoods without and with holding, and of the latter the chance per pair and the hold fraction."""
    holds = np.concatenate([[0.0], np.geomspace(1e-4, 0.5, 40), 1.0 - np.geomspace(0.48, 0.005, 40)])
    best = (-np.inf, np.zeros(0), 0.0)
    null = -np.inf
    for factor in _SPREADS if step else (1.0,):
        chance = chance_equal(motion, factor * np.sqrt(2.0) * sigma, step)
        # pairs with a like chance are alike: a histogram replaces the sum over rows
        level = np.linspace(0.0, 1.0, 201)
        index = np.clip(np.searchsorted(level, chance), 0, 200)
        alike, other = np.bincount(index, same, 201), np.bincount(index, 1.0 - same, 201)
        mean = np.bincount(index, chance, 201) / np.maximum(alike + other, 1.0)
        p = np.clip(holds[:, None] + (1.0 - holds[:, None]) * mean, _TINY, 1.0 - _TINY)
        scores = np.log(p) @ alike + np.log1p(-p) @ other
        null = max(null, float(scores[0]))
        top = int(np.argmax(scores))
        if scores[top] > best[0]:
            best = (float(scores[top]), chance, float(holds[top]))
    chance, hold = best[1], best[2]
    for _ in range(_REFINED if hold > 0.0 else 0):  # from the grid's value on: a step of EM
        hold = float(np.mean(same * hold / (hold + (1.0 - hold) * chance)))
    return null, best[0], chance, hold


def _again(y: FloatArray, repeats: npt.NDArray[np.int64]) -> Estimate:
    """How many of the readings after a repeat are the same once more; with Wilson's interval."""
    after = repeats[repeats < y.size - 2]
    if not after.size:
        return Estimate(0.0, (0.0, 1.0))
    count = int(np.count_nonzero(y[after + 2] == y[after + 1]))
    low, high = binomtest(count, after.size).proportion_ci(method="wilson")
    return Estimate(count / after.size, (float(low), float(high)))


def _regularity(y: FloatArray) -> tuple[float, tuple[float, float]]:
    """1 - variance of the run lengths over that of random holding with the same mean; with a normal interval."""
    changes = np.flatnonzero(np.diff(y) != 0.0)
    runs = np.diff(changes).astype(np.float64)
    mean = float(runs.mean()) if runs.size else 1.0
    random = mean * (mean - 1.0)
    if runs.size < 10 or random <= 0.0:
        return 0.0, (0.0, 1.0)
    # a long rest at one value is one long run: the tenth of longest runs says nothing about the refresh
    kept = np.sort(runs)[: max(10, int(0.9 * runs.size))]
    mean = float(kept.mean())
    value = 1.0 - float(kept.var()) / max(mean * (mean - 1.0), 1e-9)
    error = 2.8 / np.sqrt(kept.size)
    return max(value, -1.0), (max(value - error, -1.0), min(value + error, 1.0))
