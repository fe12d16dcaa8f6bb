"""How much of the gap a model closes, against the noise floor, on held-out residuals.

reducible_closed = 1 - (after^2 - floor^2) / (before^2 - floor^2), with RMS values. Intervals come from a moving-block
bootstrap with blocks of at least five noise correlation times and longer than the error's own memory; before and after
are resampled together.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.diagnosis import Gap, Share
from twin.noise.model import SignalNoise
from twin.where.bootstrap import block_rows, block_sums, interval, resample
from twin.where.telescope import FLOOR_DOUBT

NOTHING_TO_CLOSE = 1.05  # before / floor: below it the closed share is a quotient of noises
#: Standard error of a floor over the floor where it was measured with motion in it.
MOVING_DOUBT = 0.2


def rms(residual: FloatArray) -> float:
    """Root mean square of the known rows; NaN if there are none."""
    known = residual[np.isfinite(residual)]
    return float(np.sqrt(np.mean(np.square(known)))) if known.size else float("nan")


def floor_doubt(noise: SignalNoise) -> float:
    """Standard error of a floor that was measured as `noise` was, over the floor."""
    return FLOOR_DOUBT if noise.source in ("repeats", "still") else MOVING_DOUBT


def closure(
    before: FloatArray,
    after: FloatArray,
    floor: float,
    correlation_samples: float = 1.0,
    seed: int = 0,
    floor_relative_error: float = 0.0,
) -> Share | None:
    """The closed share of the reducible squared error with its 95 % interval; None when `before` is at the floor.

    `before` and `after` are residuals of the same held-out rows, shape (n,), in the unit of `floor`; rows with a NaN
    in either are left out. Negative when the model made it worse, above 1 when `after` is below the floor, which is
    itself measured: its standard error, `floor_relative_error` of it, is part of the interval.
    """
    known = np.isfinite(before) & np.isfinite(after)
    rows = int(known.sum())
    if rows < 2 or rms(before[known]) <= NOTHING_TO_CLOSE * floor:
        return None
    squares = np.stack([np.square(before[known]), np.square(after[known])], axis=1)
    block = block_rows(correlation_samples, squares.sum(axis=1))
    means = resample(block_sums(squares, block), rows, block, seed) / rows
    floors = floor * (1.0 + floor_relative_error * np.random.default_rng(seed + 1).standard_normal(len(means)))
    reducible = means[:, 0] - floors**2
    with np.errstate(divide="ignore", invalid="ignore"):
        replicates = np.where(reducible > 0, 1.0 - (means[:, 1] - floors**2) / reducible, np.nan)
    return Share(_closed(rms(before[known]), rms(after[known]), floor), interval(replicates))


def gap(
    before: FloatArray,
    retuned: FloatArray,
    after: FloatArray,
    floor: float,
    travel: float,
    correlation_samples: float = 1.0,
    seed: int = 0,
    floor_relative_error: float = FLOOR_DOUBT,
) -> Gap:
    """The held-out numbers of a diagnosis in percent of travel; residuals, floor and travel share one unit.

    `before` and `after` are over the rows that both predict; without an `after` there is no closed share.
    """
    percent = 100.0 / travel
    common = np.isfinite(before) & np.isfinite(after)
    if common.any():  # so that the closed share is that of the errors beside it
        before, after = before[common], after[common]
    return Gap(
        before=percent * rms(before),
        retuned=percent * rms(retuned),
        after=percent * rms(after),
        noise_floor=percent * floor,
        reducible_closed=closure(before, after, floor, correlation_samples, seed, floor_relative_error),
    )


def _closed(before: float, after: float, floor: float) -> float:
    return 1.0 - (after**2 - floor**2) / (before**2 - floor**2)
