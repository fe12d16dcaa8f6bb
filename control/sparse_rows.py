"""Records whose rows are so far apart that the stem is somewhere else at each: its motion then looks like noise.

Noise is told from motion by how smooth motion is from row to row. Where it is not, what the reading shares with what
should move it still tells the two apart: noise has nothing in common with that.
"""

from __future__ import annotations

import numpy as np

from hal.errors import BadInput
from logs.recording import FloatArray, Recording

#: Correlation of the reading with what should move it. A play and a lag leave more, noise over 50 rows a third of it.
_MOVED = 0.75


def refuse_sparse_motion(recording: Recording, mover: FloatArray) -> None:
    """For a record whose noise seems to be as large as its motion; `mover`: the command or a model's stem, (n,).

    Raises: `BadInput` where the reading goes with the mover, and is therefore no noise.
    """
    # what a row is told may be done by the next one only
    if max(_together(recording.position, mover), _together(recording.position[1:], mover[:-1])) > _MOVED:
        raise BadInput(
            f"{recording.name}: the position goes with the command, but changes so much from row to row (every "
            f"{recording.period_s:.4g} s) that its motion cannot be told from noise; record more often, rest for some "
            "rows at each level, or make the reading quieter"
        )


def _together(reading: FloatArray, mover: FloatArray) -> float:
    """Correlation where both are known; 0 where one of them never changes."""
    seen = np.isfinite(reading) & np.isfinite(mover)
    if np.count_nonzero(seen) < 3 or min(np.ptp(reading[seen]), np.ptp(mover[seen])) <= 0.0:
        return 0.0
    return float(np.corrcoef(reading[seen], mover[seen])[0, 1])
