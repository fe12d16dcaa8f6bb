"""Shares of the reducible squared error over strata of the record: direction, regime, position, pressure, time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray
from twin.diagnosis import Bin, Share
from twin.where.ratio import block_rows
from twin.where.telescope import least_excess, shares_of

IntArray = npt.NDArray[np.int64]

_WITHIN = 4.0  # memories per block


def class_shares(
    error: FloatArray,
    classes: IntArray,
    names: Sequence[str],
    noise_sigma: float,
    correlation_samples: float = 1.0,
    laid_out: bool = False,
) -> dict[str, Share] | None:
    """Shares of sum(error^2 - sigma^2) over classes 0..len(names)-1, summing to 1; None without reducible error.

    Rows with a NaN error or a class outside the names are left out. A class quieter than the floor has share 0.
    `laid_out`: the classes are bins of what the commands lay out, visited seldom and for long, or of time.
    """
    used = np.isfinite(error) & (classes >= 0) & (classes < len(names))
    excess = np.square(error[used]) - noise_sigma**2
    spread = np.zeros((excess.size, len(names)))
    spread[np.arange(excess.size), classes[used]] = excess
    least = least_excess(excess.size, noise_sigma, correlation_samples)
    block = _within(excess, classes[used], len(names), correlation_samples) if laid_out else None
    return shares_of(spread, list(names), least, correlation_samples, signed=False, block=block)


def _within(excess: FloatArray, classes: IntArray, count: int, correlation_samples: float) -> int:
    """Rows per block by what the error remembers within a class.

    Which class the rows of a block belong to counts as chance although it is none, the more the longer the block.
    """
    if excess.size == 0:
        return 1
    rows = np.maximum(np.bincount(classes, minlength=count), 1)
    means = np.bincount(classes, excess, count) / rows
    return block_rows(correlation_samples, excess - means[classes], _WITHIN)


def bin_shares(
    error: FloatArray,
    quantity: FloatArray,
    edges: FloatArray,
    noise_sigma: float,
    correlation_samples: float = 1.0,
) -> tuple[Bin, ...] | None:
    """Shares over the bins of a quantity; values outside the outer edges count to the outer bins."""
    count = edges.size - 1
    classes = np.clip(np.searchsorted(edges, quantity, side="right") - 1, 0, count - 1)
    classes = np.where(np.isfinite(quantity), classes, -1).astype(np.int64)
    shares = class_shares(
        error, classes, [str(i) for i in range(count)], noise_sigma, correlation_samples, laid_out=True
    )
    if shares is None:
        return None
    return tuple(Bin(float(edges[i]), float(edges[i + 1]), shares[str(i)]) for i in range(count))


def even_edges(quantity: FloatArray, bins: int = 10, low: float | None = None, high: float | None = None) -> FloatArray:
    """Edges of `bins` even bins over the known range, or over low..high."""
    known = quantity[np.isfinite(quantity)]
    first = float(known.min()) if low is None else low
    last = float(known.max()) if high is None else high
    return np.linspace(first, last if last > first else first + 1.0, bins + 1)
