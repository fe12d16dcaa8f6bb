"""Which of many starts are worth a full fit: the best few of them are followed a little way, and then compared again.

What acts at a place of the stroke, or from a moment on, has a valley beside every place at which the stem turned, and
the start that leaves least is often not in the deepest one. How many starts, and how far: see
`docs/decisions/contest-of-starts.md`.
Source: successive halving, Karnin, Koren, Somekh, Proc. ICML 28 (2013) 1238.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray
from twin.fit.least_squares import Residuals, descend, minimise
from twin.fit.space import Space

#: How many starts go on, and over how many rounds each.
_HEATS = ((6, 1), (3, 2))


def ranked(residuals: Residuals, starts: Sequence[FloatArray]) -> list[FloatArray]:
    """The starts, best first; a single one needs no look."""
    if len(starts) == 1:
        return list(starts)
    return [starts[i] for i in np.argsort([float(r @ r) for r in map(residuals, starts)])]


def rough_unknowns(space: Space) -> npt.NDArray[np.int64]:
    """Where in z the unknowns stand to which the response jumps."""
    return np.array([k for k, u in enumerate(space.unknowns) if not u.smooth], dtype=np.int64)


def followed(residuals: Residuals, space: Space, best_first: Sequence[FloatArray], most: int) -> list[FloatArray]:
    """The `most` best of the starts, as far as they were followed.

    Wrong numbers alone start where they stand: the best of those, which has not been moved for what is noise.
    """
    if len(best_first) <= most or all(cause.form is None for cause in space.causes):
        return list(best_first[:most])
    rough, left = rough_unknowns(space), list(best_first)
    if rough.size:
        left = [descend(residuals, z, rough, space.lower, space.upper) for z in left[: _HEATS[0][0]]]
    for how_many, rounds in _HEATS:
        found = [_followed(residuals, space, z, rounds) for z in left[:how_many]]
        left = [z for z, _cost in sorted(found, key=lambda one: one[1])]
    return left[:most]


def _followed(residuals: Residuals, space: Space, start: FloatArray, rounds: int) -> tuple[FloatArray, float]:
    """How far `start` comes in its effects' own unknowns, and what it leaves; design numbers stay where they are."""
    numbers = len(space.numbers)
    head = start[:numbers]

    def of_own(own: FloatArray) -> FloatArray:
        return residuals(np.concatenate([head, own]))

    own = slice(numbers, None)
    found = minimise(of_own, start[own], space.lower[own], space.upper[own], space.steps[own], rounds)
    return np.concatenate([head, found.z]), found.cost
