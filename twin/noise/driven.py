"""What a stem does at its command's jitter, in stretches that look like rest: motion, and no noise.

A loop about a restless flow commands a little up and down in every row, and a valve with a positioner follows. Within a
window of twenty rows such a stem goes nowhere, so that it passes for one at rest behind a loud gauge. Its readings can
be told from the commands before them, though, and go the same way; noise that a controller answers goes the other.
Source: Ljung, System Identification (2nd ed., Prentice Hall 1999), section 7.3 (impulse responses by least squares).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import FloatArray, Recording
from twin.noise.still import parabola

#: Commands are taken as their means over so many rows before a reading, back to back.
_MEANS = (1, 2, 4, 8, 16)
#: Of the squares: what commands must explain to be heard. By chance they explain a hundredth of a few hundred rows.
_SHARE = 0.2

Rows = tuple[int, int]


def undriven(pieces: Sequence[FloatArray], rows: Sequence[tuple[Recording, Rows]]) -> list[FloatArray]:
    """The pieces of a position, less what the commands before each reading explain of them.

    `rows` says of every piece whose rows [a, b) of which recording it has. As they were where the commands explain
    little, or where the position goes against them: that is a controller which answers noise.
    """
    if not pieces:
        return []
    features = np.concatenate([_commanded(r.command, a, b) for r, (a, b) in rows])
    values = np.concatenate(list(pieces))
    seen = np.isfinite(values)
    if np.count_nonzero(seen) <= 10 * len(_MEANS):
        return list(pieces)
    weights = np.linalg.lstsq(features[seen], values[seen], rcond=None)[0]
    left = values - features @ weights
    if np.sum(weights) <= 0.0 or np.sum(left[seen] ** 2) > (1.0 - _SHARE) * np.sum(values[seen] ** 2):
        return list(pieces)
    return np.split(left, np.cumsum([piece.size for piece in pieces])[:-1])


def _commanded(command: FloatArray, first: int, end: int) -> FloatArray:
    """Means of the commands before each of the rows [first, end), shape (end - first, 5), less their parabola."""
    total = np.concatenate([[0.0], np.cumsum(command - command[first])])
    rows = np.arange(first, end)
    columns, late = [], rows
    for width in _MEANS:
        early = np.maximum(late - width, 0)
        columns.append((total[late] - total[early]) / np.maximum(late - early, 1))
        late = early
    means = np.stack(columns, axis=1)
    basis = parabola(rows.size)
    return np.asarray(means - basis @ (basis.T @ means))
