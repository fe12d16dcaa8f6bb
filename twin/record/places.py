"""Whether recordings share a clock, and where on it each begins: what drifts goes on between them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise

from logs.recording import Recording
from twin.model.place import Place

#: Recordings that together fill less than this share of the time from the first to the last have clocks of their own,
#: as far as a drift is concerned: what went on in between nobody knows.
_FILLED = 0.05
#: Those that fill less than this have breaks, in which it may have begun anew: a bench that is left alone cools down.
_WHOLE = 0.9


def places(recordings: Sequence[Recording]) -> list[Place]:
    """The place of each recording. They share a clock where one begins after the other has ended, in any order."""
    of = len(recordings)
    spans = sorted((float(r.time_s[0]), float(r.time_s[-1])) for r in recordings)
    whole_s = spans[-1][1] - spans[0][0] if spans else 0.0
    apart = all(before[1] <= after[0] for before, after in pairwise(spans))
    recorded_s = sum(r.duration_s for r in recordings)
    if of < 2 or not apart or recorded_s < _FILLED * whole_s:
        lasting_s = [0.0, *accumulate(r.duration_s for r in recordings)]
        return [Place(k, of, before_s=lasting_s[k], all_s=lasting_s[-1]) for k in range(of)]
    broken = recorded_s < _WHOLE * whole_s
    return [Place(k, of, float(r.time_s[0]) - spans[0][0], whole_s, broken=broken) for k, r in enumerate(recordings)]
