"""95 % intervals of fitted numbers when the residuals hang together in time.

The scores of a fit are summed over blocks longer than the residuals' memory, and the scatter of the block sums takes
the place of the variance of independent errors. Source: cluster-robust ("sandwich") covariance, Cameron and Miller,
"A Practitioner's Guide to Cluster-Robust Inference", Journal of Human Resources 50 (2015), section II.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray

FEWEST_BLOCKS, MOST_BLOCKS = 12, 200
MEMORIES_PER_BLOCK = 10.0


@dataclass(frozen=True, slots=True)
class Interval:
    """A value and its 95 % confidence interval."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        return 0.5 * (self.high - self.low)

    def holds(self, value: float) -> bool:
        return self.low <= value <= self.high


def memory_rows(residual: FloatArray) -> float:
    """How many rows one independent row is worth: the sum of the autocorrelation up to its first negative value."""
    n = residual.size
    centred = residual - residual.mean()
    power = float(centred @ centred)
    if n < 8 or power <= 0.0:
        return 1.0
    size = 1 << (2 * n - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(centred, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: n // 4] / power
    negative = np.flatnonzero(correlation < 0.0)
    end = int(negative[0]) if negative.size else correlation.size
    return float(max(1.0, 1.0 + 2.0 * correlation[1:end].sum()))


def covariance(jacobian: FloatArray, residual: FloatArray) -> tuple[FloatArray, int]:
    """Covariance of the parameters of a least-squares fit, shape (p, p), and its degrees of freedom.

    `jacobian` is d prediction / d parameter, shape (n, p). A parameter that changes nothing has an infinite variance.
    """
    n, p = jacobian.shape
    size = np.linalg.norm(jacobian, axis=0)
    active = size > 1e-10 * max(float(size.max(initial=0.0)), 1e-300)
    result = np.full((p, p), 0.0)
    result[~active, ~active] = np.inf
    if not active.any():
        return result, 1
    scaled = jacobian[:, active] / size[active]
    blocks = int(np.clip(n / (MEMORIES_PER_BLOCK * memory_rows(residual)), FEWEST_BLOCKS, MOST_BLOCKS))
    blocks = max(2, min(blocks, n // 2))
    starts = np.linspace(0, n, blocks, endpoint=False).astype(int)
    scores = np.add.reduceat(scaled * residual[:, None], starts, axis=0)
    bread = np.linalg.pinv(scaled.T @ scaled, rcond=1e-12, hermitian=True)
    meat = scores.T @ scores * blocks / (blocks - 1.0)
    white = bread * float(residual @ residual) / max(1, n - p)  # independent errors: never less than this
    found = bread @ meat @ bread
    widen = np.sqrt(np.maximum(np.diag(white) / np.maximum(np.diag(found), 1e-300), 1.0))
    found = found * np.outer(widen, widen)
    result[np.ix_(active, active)] = found / np.outer(size[active], size[active])
    return result, max(1, blocks - 1)


def intervals(values: FloatArray, jacobian: FloatArray, residual: FloatArray) -> list[Interval]:
    """One 95 % interval per value. `residual` = data - prediction, shape (n,)."""
    from scipy.stats import t as student

    spread, freedom = covariance(jacobian, residual)
    reach = float(student.ppf(0.975, freedom)) * np.sqrt(np.diag(spread))
    return [Interval(float(v), float(v - r), float(v + r)) for v, r in zip(values, reach, strict=True)]
