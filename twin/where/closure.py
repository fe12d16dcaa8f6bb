"""How much of the gap a model closes, against the noise floor, on held-out residuals.

reducible_closed = 1 - (after^2 - floor^2) / (before^2 - floor^2), with RMS values. Its interval is Fieller's, with
variances from blocks that are longer than what the error remembers (`twin/where/ratio.py`).
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.diagnosis import Gap, Share
from twin.noise.model import SignalNoise
from twin.where.ratio import ratio_interval
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
    reducible = np.square(before[known]) - floor**2
    gained = np.square(before[known]) - np.square(after[known])
    doubt = rows * 2.0 * floor**2 * floor_relative_error  # the floor is off in all rows alike, and only in `reducible`
    ends = ratio_interval(gained, reducible, correlation_samples, doubt)
    return Share(_closed(rms(before[known]), rms(after[known]), floor), ends)


def gap(
    before: FloatArray,
    retuned: FloatArray,
    after: FloatArray,
    floor: float,
    travel: float,
    correlation_samples: float = 1.0,
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
        reducible_closed=closure(before, after, floor, correlation_samples, floor_relative_error),
    )


def _closed(before: float, after: float, floor: float) -> float:
    return 1.0 - (after**2 - floor**2) / (before**2 - floor**2)
