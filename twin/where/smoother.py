"""Measured pressure with its noise taken off and its edges left on, fit to drive a model with play.

A play ratchets on noise: driven by a raw reading it creeps to the outermost excursions. A plain filter would round the
steps instead. So only what the reading adds to the model's pressure is averaged, at every row over as many rows before
and, apart from them, after it as the readings allow: next to an edge only on the side where none is.
Sources: Goldenshluger & Nemirovski, "On spatially adaptive estimation of nonparametric regression", 1997 (intersection
of confidence intervals); Katkovnik, Egiazarian & Astola, "Local approximation techniques", 2006 (one-sided averages).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

LONGEST_S = 3.5  # to either side: as many readings together as under a bell of 2 s
#: Standard deviations to either side of an average, outside of which its pressure is not.
_SURE = 2.5
_LONGER = 1.5  # from one average to the next

#: The correlation, at lags of 0, 1, ... rows, of noise without a memory.
WHITE: FloatArray = np.ones(1)


def smooth_pressure(
    measured: FloatArray, model: FloatArray, noise_sigma: float, period_s: float, correlation: FloatArray = WHITE
) -> tuple[FloatArray, FloatArray]:
    """A(c) + average(p - A(c)), without delay, and the variance that is left of the readings' noise: shape (n,) each.

    `model` is A(c), the pressure the model has for the command; `correlation`, shape (lags,), that of the noise, of
    standard deviation `noise_sigma`. An average goes on to either side while a value within `_SURE` of its standard
    deviations, and of those of all shorter ones, is left. Missing readings are bridged by their neighbours.
    """
    known = np.isfinite(measured)
    if not known.any():
        return model.copy(), np.full(model.size, np.inf)
    excess = np.where(known, measured - model, 0.0)
    if noise_sigma <= 0.0:
        return model + _bridged(excess, known), np.zeros(model.size)
    lengths = _lengths(period_s)
    # a memory is of so many rows, of which only some have a reading
    spacing = known.size / np.count_nonzero(known)
    variances = noise_sigma**2 * mean_variances(correlation, lengths[-1], spacing)
    sides = [
        _one_sided(excess[way], known[way], variances, lengths, way) for way in (slice(None), slice(None, None, -1))
    ]
    weights = [1.0 / variance for _, variance in sides]
    total = weights[0] + weights[1]
    near = total > 0.0
    both = (sides[0][0] * weights[0] + sides[1][0] * weights[1]) / np.where(near, total, 1.0)
    return model + _bridged(both, near), np.where(near, 1.0 / np.where(near, total, 1.0), np.inf)


def mean_variances(correlation: FloatArray, longest: int, spacing: float = 1.0) -> FloatArray:
    """Variance of the mean of 0, 1, ... `longest` readings, `spacing` rows apart, in that of one; inf of none."""
    lags = np.arange(1, longest)
    rho = np.interp(spacing * lags, np.arange(correlation.size), correlation, right=0.0)
    sums, moments = np.cumsum(np.append(0.0, rho)), np.cumsum(np.append(0.0, lags * rho))
    count = np.arange(1, longest + 1)
    means = (1.0 + 2.0 * (sums - moments / count)) / count
    return np.append(np.inf, np.clip(means, 1e-6, 1.0))


def _lengths(period_s: float) -> list[int]:
    lengths, most = [1], max(LONGEST_S / period_s, 1.0)
    while (longer := max(lengths[-1] + 1, round(_LONGER * lengths[-1]))) <= most:
        lengths.append(longer)
    return lengths


def _one_sided(
    excess: FloatArray, known: npt.NDArray[np.bool_], variances: FloatArray, lengths: list[int], way: slice
) -> tuple[FloatArray, FloatArray]:
    """Averages over each row and those after it, and their variances (inf: no reading), both turned back as `way`."""
    n = excess.size
    sums, counts = np.append(0.0, np.cumsum(excess * known)), np.append(0, np.cumsum(known))
    rows = np.arange(n)
    low, high = np.full(n, -np.inf), np.full(n, np.inf)
    found, found_variance = np.zeros(n), np.full(n, np.inf)
    for length in lengths:
        ends = np.minimum(rows + length, n)
        count = counts[ends] - counts[rows]
        mean, variance = (sums[ends] - sums[rows]) / np.maximum(count, 1), variances[count]
        low, high = (
            np.maximum(low, mean - _SURE * np.sqrt(variance)),
            np.minimum(high, mean + _SURE * np.sqrt(variance)),
        )
        better = (low <= high) & (variance < found_variance)  # once apart, low and high stay so
        found, found_variance = np.where(better, mean, found), np.where(better, variance, found_variance)
    return found[way], found_variance[way]


def _bridged(values: FloatArray, known: npt.NDArray[np.bool_]) -> FloatArray:
    bridged: FloatArray = np.interp(np.arange(values.size), np.flatnonzero(known), values[known])
    return bridged
