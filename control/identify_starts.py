"""Rough first guesses of a valve's numbers, made of nothing but how far pressure and position go, in any units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from control.identify_model import TRAVEL
from logs.recording import FloatArray

NEVER = 1e9  # a travel or a rate limit that is never reached
FAR = 0.25  # of what the stem moved, that it stayed away from fully open: both curves then begin outside the record


@dataclass(frozen=True, slots=True)
class Reach:
    """What a record goes through: lowest and highest pressure, and of the position without its last half percents."""

    p_low: float
    p_high: float
    low: float
    top: float

    @property
    def span(self) -> float:
        return self.p_high - self.p_low

    @property
    def width(self) -> float:
        return self.top - self.low

    @property
    def away(self) -> float:
        """The lowest position of a stem that never came near fully open; 0 of one that did."""
        return self.low if self.low > FAR * self.width else 0.0


def first_guesses(reach: Reach, cost: Callable[[FloatArray], float]) -> list[FloatArray]:
    """The cheapest guess of the eight numbers of a fit for each width of the play, and the best without a stop.

    One of each width, since a fit that starts without a play seldom finds one, and the cheapest few are often alike.
    """
    best = [min(_guesses(reach, band), key=cost) for band in (0.0, 0.1, 0.2, 0.33, 0.5)]
    open_ended = min(best, key=cost).copy()
    open_ended[TRAVEL] = NEVER
    return [*best, open_ended]


def _guesses(reach: Reach, band: float) -> list[FloatArray]:
    """Guesses whose play takes the share `band` of the range of pressures."""
    guesses = []
    for away, slope, place, tau_s in product(
        sorted({0.0, reach.away}), (1.0, 1.5, 2.5), (0.1, 0.3, 0.5, 0.7), (0.5, 3.0, 12.0)
    ):
        compliance = slope * reach.width / (reach.span * (1.0 - band))
        room = reach.span * (1.0 - band) - reach.width / compliance * 0.8
        a2 = reach.p_low + place * max(room, 0.3 * reach.span) - away / compliance
        guesses.append(np.array([a2 + band * reach.span, a2, compliance, compliance, tau_s, NEVER, reach.top, np.nan]))
    return guesses
