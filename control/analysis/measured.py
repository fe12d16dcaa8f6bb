"""Limit cycles measured on a bench: what the stem does after the loop has been left alone for a while."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
LASTS = 0.95  # near its border a loop can take an hour to come to rest; 5 % less within a quarter record is dying


@dataclass(frozen=True, slots=True)
class MeasuredCycle:
    """Half the peak-to-peak of the stem [in] and the mean period [s] over `cycles` whole cycles."""

    stem_in: float
    period_s: float
    cycles: int


def measure_cycle(time_s: FloatArray, stem_in: FloatArray, smallest_in: float) -> MeasuredCycle | None:
    """The oscillation in the last half of a record; None where there are less than two cycles, it is too small, or it
    dies out (the last quarter has less than 95 % of the swing of the quarter before).

    Crossings of the mean count after an excursion of a quarter of the amplitude, so that noise does not.
    """
    half = time_s.size // 2
    t, x = time_s[half:], stem_in[half:]
    if np.ptp(x[x.size // 2 :]) < LASTS * np.ptp(x[: x.size // 2]):
        return None
    low, high = np.percentile(x, [1.0, 99.0])
    amplitude = 0.5 * float(high - low)
    if amplitude < smallest_in:
        return None
    level, away = 0.5 * (low + high), 0.25 * amplitude
    ups, below = [], False
    for now_s, value in zip(t, x, strict=True):
        if value < level - away:
            below = True
        elif below and value > level + away:
            ups.append(float(now_s))
            below = False
    if len(ups) < 3:
        return None
    return MeasuredCycle(amplitude, float(np.diff(ups).mean()), len(ups) - 1)
