"""Intervals of ratios of sums over correlated samples: the moving-block bootstrap, on block sums.

Source: Künsch, "The jackknife and the bootstrap for general stationary observations", Annals of Statistics 17, 1989.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

DRAWS = 1000
_MOST_BLOCKS = 300  # more blocks than this change the interval by less than its own scatter


def block_rows(correlation_samples: float, values: FloatArray, least: int = 20) -> int:
    """Rows per block: at least five noise correlation times and three of the values' own, at most an eighth of them."""
    rows = values.size
    wanted = max(least, 5.0 * correlation_samples, 3.0 * memory_rows(values), rows / _MOST_BLOCKS)
    return max(1, min(int(np.ceil(wanted)), rows // 8))


def memory_rows(values: FloatArray) -> float:
    """Integrated autocorrelation time [rows], at least 1, summed up to where the correlation first falls below 0.05."""
    centred = values - values.mean()
    power = np.square(np.abs(np.fft.rfft(centred, 1 << int(2 * values.size - 1).bit_length())))
    covariance = np.fft.irfft(power)[: values.size // 4 + 1]
    if not covariance[0] > 0.0:
        return 1.0
    rho = covariance / covariance[0]
    end = int(np.argmax(rho < 0.05)) or rho.size
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


def resample(sums: FloatArray, rows: int, block: int, seed: int = 0, draws: int = DRAWS) -> FloatArray:
    """Bootstrap replicates of the column totals, shape (draws, columns): each adds as many blocks as fill the rows."""
    rng = np.random.default_rng(seed)
    blocks = sums.shape[0]
    take = max(1, round(rows / block))
    counts: npt.NDArray[np.int64] = rng.multinomial(take, np.full(blocks, 1.0 / blocks), size=draws)
    return np.asarray(counts @ sums) * (rows / (take * block))


def interval(replicates: FloatArray) -> tuple[float, float]:
    """The 2.5 % and 97.5 % points; a replicate that is not finite is left out."""
    finite = replicates[np.isfinite(replicates)]
    if finite.size == 0:
        return float("nan"), float("nan")
    low, high = np.percentile(finite, [2.5, 97.5])
    return float(low), float(high)
