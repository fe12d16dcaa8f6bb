"""Intervals of ratios of sums over correlated samples: Fieller's, with variances from sums over long blocks.

A ratio of two sums is skewed where its denominator is not sure; Fieller's interval holds all ratios that the two sums
do not contradict, and so needs no resampling. The variances come from few blocks where a record is short, hence
Student's factor. Measured by `bench/interval_coverage.py`.

Sources: Fieller, "Some problems in interval estimation", J. R. Stat. Soc. B 16 (1954) 175; for batch means that
overlap, Meketon, Schmeiser, Proc. Winter Simulation Conf. (1984) 227.
"""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from logs.recording import FloatArray

#: Rows per block, in memories: with 3 the variance comes out a sixth too small, with 8 a sixteenth.
_MEMORIES = 8.0
_NOISE_MEMORIES = 5.0
_LEAST_ROWS, _LEAST_BLOCKS = 20, 8
_MOST_BLOCKS = 300  # more blocks than this change the interval by less than its own scatter
#: Below this a correlation is nothing; and so many sums a memory is looked for in at least.
_NOTHING, _LEAST_SUMS = 0.05, 48


def ratio_interval(
    numerator: FloatArray,
    denominator: FloatArray,
    correlation_samples: float = 1.0,
    doubt: float = 0.0,
    block: int | None = None,
) -> tuple[float, float]:
    """The 95 % interval of sum(numerator) / sum(denominator), arrays of shape (n,) over rows in their order.

    `correlation_samples` is that of the noise [rows]; `doubt` the standard error of the denominator's sum that is not
    in its rows; `block` the rows of a block, by the memory of what decides the ratio unless given. A denominator that
    may be 0 leaves every ratio possible: then the interval is that of small errors, which is wide. NaN from one row.
    """
    rows = numerator.size
    if rows < 2:
        return float("nan"), float("nan")
    n, d = float(numerator.sum()), float(denominator.sum())
    ratio = n / d
    block = block or block_rows(correlation_samples, numerator - ratio * denominator)
    quantile = float(stdtrit(rows / block - 1.0, 0.975))
    v = quantile**2 * total_covariance(np.stack([numerator, denominator], axis=1), block)
    v[1, 1] += (quantile * doubt) ** 2
    # all ratios q with (n - q d)^2 <= v[0, 0] - 2 q v[0, 1] + q^2 v[1, 1]
    a, b, c = d**2 - v[1, 1], n * d - v[0, 1], n**2 - v[0, 0]
    if a <= 0.0:
        half = np.sqrt(max(v[0, 0] - 2.0 * ratio * v[0, 1] + ratio**2 * v[1, 1], 0.0)) / abs(d)
        return float(ratio - half), float(ratio + half)
    half = np.sqrt(max(b**2 - a * c, 0.0))
    # the ratio itself lies within, but for rounding
    return float(min((b - half) / a, ratio)), float(max((b + half) / a, ratio))


def total_covariance(columns: FloatArray, block: int) -> FloatArray:
    """Covariance of the totals of `columns`, shape (n, k), from sums over blocks of so many rows; shape (k, k)."""
    rows = columns.shape[0]
    sums = block_sums(columns, block)
    centred = sums - sums.mean(axis=0)
    blocks = rows / block
    return np.asarray(centred.T @ centred * (blocks / len(sums) * blocks / (blocks - 1.0)))


def block_rows(correlation_samples: float, values: FloatArray, memories: float = _MEMORIES) -> int:
    """Rows per block for `values`, shape (n,): five correlation times of the noise and `memories` of their own, at
    least; at most an eighth of them, so that there is something to tell their scatter from."""
    rows = values.size
    wanted = max(
        _LEAST_ROWS, _NOISE_MEMORIES * correlation_samples, memories * memory_rows(values), rows / _MOST_BLOCKS
    )
    return max(1, min(int(np.ceil(wanted)), rows // _LEAST_BLOCKS))


def memory_rows(values: FloatArray) -> float:
    """Integrated autocorrelation time [rows] of `values`, shape (n,), at least 1.

    Also of sums over 4, 8, 16, ... rows: a slow part below much noise has correlations next to nothing from row to row,
    but many of them. The longest counts.
    """
    longest = _memory(values, _NOTHING)
    width = 4
    while (count := values.size // width) >= _LEAST_SUMS:
        sums = values[: count * width].reshape(count, width).sum(axis=1)
        # what one sum holds is no sign of memory, nor is a correlation that chance alone would give
        longest = max(longest, width * (_memory(sums, max(_NOTHING, 2.0 / count**0.5)) - 1.0))
        width *= 2
    return longest


def _memory(values: FloatArray, nothing: float) -> float:
    """Integrated autocorrelation time, at least 1, up to where the correlation first falls below `nothing`."""
    centred = values - values.mean()
    power = np.square(np.abs(np.fft.rfft(centred, 1 << int(2 * values.size - 1).bit_length())))
    covariance = np.fft.irfft(power)[: values.size // 4 + 1]
    if not covariance[0] > 0.0:
        return 1.0
    rho = covariance / covariance[0]
    end = int(np.argmax(rho < nothing)) or rho.size
    return float(max(1.0, 1.0 + 2.0 * rho[1:end].sum()))


def block_sums(values: FloatArray, block: int) -> FloatArray:
    """Sums over overlapping blocks that start every half block; shape (blocks, columns) from values (n, columns).

    Starting points wrap around, so that every row lies in the same number of blocks.
    """
    rows = values.shape[0]
    step = max(1, block // 2)
    starts = np.arange(0, rows, step)
    padded = np.concatenate([values, values[: block % rows if block >= rows else block]])
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(padded, axis=0)])
    stops = np.minimum(starts + block, padded.shape[0])
    return np.asarray(total[stops] - total[starts])
