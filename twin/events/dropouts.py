"""Isolated false readings: one to three samples away from both neighbours, at no place where the stem could have been.

They hide in a noise floor taken from repeats, so they are found by their look and masked for every fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter
from scipy.stats import beta

from logs.recording import FloatArray
from twin.diagnosis import Estimate
from twin.events.evidence import Evidence, nothing
from twin.events.tails import NEAR, Tail
from twin.noise.model import poisson_tail

BoolArray = npt.NDArray[np.bool_]

#: Of the noise; a reading has to stand out by so much to be called false.
SIGMAS = 6.0
_LONGEST = 3
_JUMP = 5.0  # times the usual step from reading to reading around it
_WINDOW = 9
#: False readings that prove that there are some; and by how much further one has to be beside its way than any step
#: around it, or than its neighbours are beside theirs: the tip of a motion is no further beside than such a step.
_PROVEN, _FURTHER, _SHARPER = 3, 1.25, 1.5
_AROUND = 4
_FALSE_RATE = 1e-7  # per row, of a Gaussian reading beyond six sigma that also comes back


@dataclass(frozen=True, slots=True)
class Dropouts:
    """`rows` marks the false readings, shape (n,); `codes` are values that many of them share (zero, full scale)."""

    rows: BoolArray
    evidence: Evidence
    tail: Tail
    codes: tuple[float, ...] = ()


def find_dropouts(reading: FloatArray, noise_sigma: float, effect: str = "sensor_dropouts") -> Dropouts:
    """False readings of one signal; `noise_sigma` in its unit. Estimates: `rate` per reading, median `size`.

    NaN counts as missing, not as false. Runs longer than three samples are no drop-outs but something that moved.
    """
    known = np.isfinite(reading)
    rows = np.zeros(reading.size, dtype=bool)
    if known.sum() < 3 * _WINDOW:
        return Dropouts(rows, nothing(effect, "fewer than 27 readings"), Tail(0, np.empty(0)))
    y = reading[known]
    # mirrored at the ends: a false first reading would otherwise be most of its own neighbours
    apart = y - median_filter(y, _WINDOW, mode="mirror")
    sigma = max(noise_sigma, 1e-12)
    bound = SIGMAS * sigma
    steps = np.abs(np.diff(y, prepend=y[:1]))
    # false readings in a motion move the median of their neighbours by a step or two, which are not far for that
    reach = bound + 2.0 * median_filter(steps, 2 * _WINDOW + 1, mode="mirror")
    false = _isolated(y, np.abs(apart) > reach, bound)
    near = false | _isolated(y, np.abs(apart) > NEAR * reach, bound, NEAR)
    if np.count_nonzero(false) >= _PROVEN:
        false |= _beside_their_way(y, bound)
    rows[known] = false
    count, sizes = int(false.sum()), np.abs(apart[false])
    tail = Tail(int(near.sum()), np.maximum(sizes / reach[false], 1.0))
    if count == 0:
        none = {"rate": Estimate(0.0, (0.0, 3.0 / y.size), "1/sample")}
        return Dropouts(rows, Evidence(effect, 0.0, 1.0, none), tail)
    spread = max(float(np.ptp(y)), bound)
    # each false reading: somewhere in the range, instead of that far out on a Gaussian
    gains = np.minimum(0.5 * (sizes / sigma) ** 2, 50.0) - log(spread / sigma) + log(count / y.size)
    ratio = max(0.0, float(gains.sum()))
    estimates = {
        "rate": Estimate(count / y.size, _binomial(count, y.size), "1/sample"),
        "size": Estimate(float(np.median(sizes)), (float(sizes.min()), float(sizes.max())), ""),
    }
    p_value = poisson_tail(count, _FALSE_RATE * y.size)
    return Dropouts(rows, Evidence(effect, ratio, p_value, estimates), tail, _codes(y[false]))


def _isolated(y: FloatArray, far: BoolArray, bound: float, share: float = 1.0) -> BoolArray:
    """Runs of at most three far samples that jump away from the one neighbour and back to the other, by `share` of what
    is asked of false readings.

    The tip of a motion is far from a median too, but is reached and left by steps like those around it: a false
    reading is reached and left by jumps much larger than the motion there.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], far, [False]]).astype(np.int8)))
    starts, stops = edges[::2], edges[1::2]
    before, after = y[np.maximum(starts - 1, 0)], y[np.minimum(stops, y.size - 1)]
    # at an end of the record there is one neighbour only, and it decides; what happens beyond nobody knows
    before, after = np.where(starts == 0, after, before), np.where(stops == y.size, before, after)
    away, back = y[starts] - before, y[stops - 1] - after
    steps = np.abs(np.diff(y, prepend=y[:1]))
    usual = median_filter(steps, 2 * _WINDOW + 1, mode="nearest")[starts]
    usual = np.where(starts == 0, steps[2 : _WINDOW + 2].max(), usual)
    usual = np.where(stops == y.size, steps[-_WINDOW - 1 : -1].max(), usual)
    single = (stops - starts == 1) | ((starts > 0) & (stops < y.size))
    jump = np.minimum(np.abs(away), np.abs(back)) / share
    good = (stops - starts <= _LONGEST) & (away * back > 0.0) & (jump > np.maximum(bound, _JUMP * usual)) & single
    good &= np.abs(after - before) < np.maximum(0.5 * jump, bound)
    marked = np.zeros(y.size, dtype=bool)
    for start, stop in zip(starts[good], stops[good], strict=True):
        marked[start:stop] = True
    return marked


def _beside_their_way(y: FloatArray, bound: float) -> BoolArray:
    """Single readings of a motion that lie beside the line between their neighbours, by more than a motion can.

    What is small beside the steps of a fast stem jumps neither away nor back by much more than these. This is asked
    only where there are false readings beyond doubt: a corner of a motion is no evidence for them.
    """
    padded = np.pad(y, 1, mode="edge")
    away, back = y - padded[:-2], y - padded[2:]
    beside = np.abs(0.5 * (away + back))
    steps = np.pad(np.abs(np.diff(y)), _AROUND, mode="constant")
    windows = np.lib.stride_tricks.sliding_window_view(steps, 2 * _AROUND)
    around = np.delete(windows, [_AROUND - 1, _AROUND], axis=1).max(axis=1)
    neighbours = np.maximum(np.pad(beside, 1)[:-2], np.pad(beside, 1)[2:])
    far = beside > np.maximum(np.sqrt(1.5) * bound, _FURTHER * around)
    both = (away * back > 0.0) & (np.minimum(np.abs(away), np.abs(back)) > 0.5 * bound)
    found = far & both & (beside > _SHARPER * neighbours)
    found[[0, -1]] = False
    return np.asarray(found)


def _codes(values: FloatArray) -> tuple[float, ...]:
    """Values shared exactly by at least three and a fifth of the false readings."""
    found, counts = np.unique(values, return_counts=True)
    return tuple(float(v) for v in found[counts >= max(3, values.size / 5)])


def _binomial(count: int, total: int) -> tuple[float, float]:
    """The exact 95 % interval of a rate (Clopper & Pearson 1934)."""
    low = float(beta.ppf(0.025, count, total - count + 1)) if count else 0.0
    return low, float(beta.ppf(0.975, count + 1, total - count))
