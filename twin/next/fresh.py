"""What to record where a gap is unexplained and the records are a poor ground to explain it on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from control.experiment import Experiment
from logs.recording import Recording
from twin.next.candidates import library
from twin.next.limits import Limits

#: Of the travel; a stem that moves over less shows neither both curves nor a stop.
_NARROW = 0.5
#: Quantiles between which a stem is said to move: a stray reading is no motion.
_ENDS = (0.01, 0.99)


def poor_ground(recordings: Sequence[Recording], travel: float) -> str | None:
    """Why the records are a poor ground, in words that end a sentence; None where they are a good one."""
    if all(r.target is not None and np.isfinite(r.target).any() for r in recordings):
        return "they were made in closed loop, where the command answers the error and effects hide behind each other"
    reach = max(float(np.ptp(np.nanquantile(r.position, _ENDS))) for r in recordings) / travel
    if reach < _NARROW:
        return f"the stem moves over {100.0 * reach:.0f} % of its travel only"
    return None


def open_sweep(limits: Limits) -> Experiment | None:
    """The shortest nested sweep of the library: both curves over the full stroke, with inner reversals."""
    nested = [one for one in library(limits) if one.kind == "nested"]
    return min(nested, key=lambda one: one.duration_s, default=None)
