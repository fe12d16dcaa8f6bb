"""How much of the gap a model closes, against the noise floor, and whether there is a gap; on held-out residuals.

reducible_closed = 1 - (after^2 - floor^2) / (before^2 - floor^2), with RMS values. Intervals come from a moving-block
bootstrap with blocks of at least five noise correlation times and longer than the error's own memory; before and after
are resampled together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray
from twin.diagnosis import Gap, Interval, Share
from twin.noise.model import SignalNoise
from twin.where.bootstrap import block_rows, block_sums, interval, resample
from twin.where.telescope import FLOOR_DOUBT

NOTHING_TO_CLOSE = 1.05  # before / floor: below it the closed share is a quotient of noises
#: Standard error of a floor over the floor where it was measured with motion in it.
MOVING_DOUBT = 0.2


@dataclass(frozen=True, slots=True)
class Equivalence:
    """Whether the model is as good as the floor: `excess` is sqrt(mse - floor^2), in the residual's unit, at least 0.

    `p_value` is the chance of so small an excess if the true one were `margin` (the second one-sided test of the usual
    two is void: the excess cannot be negative). Below 0.05 the gap is shown to be smaller than the margin.
    """

    excess: float
    ci95: Interval
    margin: float
    p_value: float

    @property
    def no_gap(self) -> bool:
        return self.p_value < 0.05


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
    """The held-out numbers of a diagnosis in percent of travel; residuals, floor and travel share one unit."""
    percent = 100.0 / travel
    return Gap(
        before=percent * rms(before),
        retuned=percent * rms(retuned),
        after=percent * rms(after),
        noise_floor=percent * floor,
        reducible_closed=closure(before, after, floor, correlation_samples, seed, floor_relative_error),
    )


def equivalence(
    residual: FloatArray,
    floor: float,
    margin: float,
    correlation_samples: float = 1.0,
    floor_relative_error: float = 0.0,
    seed: int = 0,
) -> Equivalence:
    """Tests that the RMS gap beyond the floor is smaller than `margin` (one unit for all three).

    `floor_relative_error` is the standard error of the floor over the floor; it widens the interval.
    """
    known = residual[np.isfinite(residual)]
    rows = known.size
    squares = np.square(known)[:, None]
    block = block_rows(correlation_samples, squares[:, 0])
    means = resample(block_sums(squares, block), rows, block, seed)[:, 0] / rows
    floors = floor * (1.0 + floor_relative_error * np.random.default_rng(seed + 1).standard_normal(means.size))
    # the pivot: the replicates scatter about the estimate as the estimate does about the truth
    excess = float(np.mean(squares)) - floor**2
    errors = (means - np.square(floors)) - excess
    p_value = float((1 + np.count_nonzero(errors + margin**2 <= excess)) / (1 + errors.size))
    low, high = interval(np.sqrt(np.maximum(excess + errors, 0.0)))
    return Equivalence(float(np.sqrt(max(excess, 0.0))), (low, high), margin, p_value)


def _closed(before: float, after: float, floor: float) -> float:
    return 1.0 - (after**2 - floor**2) / (before**2 - floor**2)
