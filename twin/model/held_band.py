"""The band within which a converter ignores commands, read from its pressure before anything is fitted.

What such a converter accepts depends on all that it accepted before: of a sine, a band that is off by a quarter of a
percent has lost step after a few turns. So bands are tried a tenth of a percent apart.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray, Recording
from twin.kernels.held import banded, held_at_first, held_squares

#: Bands that a measured pressure is held against, as shares of the command's range; how far apart those are that are
#: told apart; rows and recordings that are looked at.
_SHARES, _APART = np.geomspace(0.003, 0.3, 4600), 1.002
_ROWS, _RECORDS = 12_000, 4
#: What a band has to leave at the most of the squares that no band leaves, to be seen without a doubt.
_SEEN = 0.75
#: Variances of the noise that a pressure may leave whose row before, with its own noise, is what it is told from.
_LOUD = 3.0


def likely_bands(records: Sequence[Recording], count: int) -> list[tuple[float, float]]:
    """Pairs of what is left of the squares of the pressure, as a share of what is without a band, and the band.

    The best `count`, best first; none where no pressure was read.
    """
    read = [(r.command[:_ROWS], r.pressure[:_ROWS]) for r in records if r.pressure is not None]
    read = [(u, p) for u, p in read if np.isfinite(p[0]) and np.ptp(u) > 0.0][:_RECORDS]
    if not read:
        return []
    most = _ROWS // len(read)
    read = [(u[:most], p[:most]) for u, p in read]
    bands = _SHARES * max(float(np.ptp(u)) for u, _ in read)
    without, *left = (_left(sum((held_squares(u, p, b) for u, p in read), np.zeros((4, 4)))) for b in (0.0, *bands))
    best: list[tuple[float, float]] = []
    for k in np.argsort(left):
        if all(max(bands[k] / other, other / bands[k]) > _APART for _, other in best):
            best.append((left[k] / max(without, 1e-300), float(bands[k])))
        if len(best) == count:
            break
    return best


def accepted_rows(record: Recording, sigma: float) -> npt.NDArray[np.int64]:
    """Rows in which a converter that is seen to ignore commands within a band accepts one; none where it is not.

    `sigma`: noise of the pressure; what leaves no more than that ignores nothing.
    """
    none, pressure = np.zeros(0, dtype=np.int64), record.pressure
    if pressure is None or not np.isfinite(pressure[0]) or np.ptp(record.command[:_ROWS]) <= 0.0:
        return none
    sums = held_squares(record.command[:_ROWS], pressure[:_ROWS], 0.0)
    if _left(sums) < _LOUD * sigma**2 * sums[2, 2]:
        return none
    share, band = likely_bands([record], 1)[0]
    if share > _SEEN:
        return none
    goal, first = np.empty(record.n), float(record.command[0])
    banded(record.command, band, True, held_at_first(first, band, True, float(pressure[0])), goal)
    return np.flatnonzero(np.diff(goal, prepend=goal[0]))


def _left(sums: FloatArray) -> float:
    """What the best lag leaves of the squares of the pressure. `sums`: see `held_squares`."""
    normal = np.triu(sums) + np.triu(sums, 1).T
    known, wanted = normal[:3, :3], normal[:3, 3]
    return float(max(normal[3, 3] - wanted @ np.linalg.pinv(known) @ wanted, 0.0))
