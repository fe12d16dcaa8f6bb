"""Readings so coarse that the noise no longer blurs their steps: each says an interval, and nothing within it.

The rounding error of such a reading is no noise. It stays for as long as the stem does, has a mean at every rest, and
a thousand rows of one rest say no more than one of them; least squares would bend a model toward it. What is beyond
half a step is none of its making: only that counts. Source: Curry, Estimation and Control with Quantized Measurements
(MIT Press 1970), ch. 2; Milanese, Vicino, Automatica 27 (1991) 997 (errors that are bounded, not random).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot, sqrt

import numpy as np

from logs.recording import FloatArray, Recording

#: Noise, in steps, up to which the steps are sharp; how soon, in rows, a change that noise made is taken back.
_SHARP, _SOON = 0.12, 12
#: What a model that is right misses the edges by, in steps: instants of rows, digits of a file.
_MISSED = 0.004


@dataclass(frozen=True, slots=True)
class Coarse:
    """A reading in steps of `step`, under a noise of standard deviation `noise` (both in its unit)."""

    step: float
    noise: float

    @property
    def half(self) -> float:
        """What rounding alone makes of an error at the most."""
        return 0.5 * self.step

    @property
    def beyond(self) -> float:
        """RMS of what is beyond, for a true model: noise takes a reading over an edge that the stem is near to.

        At a distance d it does so with probability Q(d / noise); the mean of d squared over a step is 0.53 noise^3.
        """
        return sqrt((_MISSED * self.step) ** 2 + 0.532 * self.noise**3 / self.step)

    def shifted(self, difference: FloatArray) -> float:
        """Mean square of what is beyond where a prediction is off by `difference`, small against the step."""
        return float(np.mean(np.abs(difference) ** 3)) / (3.0 * self.step)

    def with_margin(self, margin: float) -> Coarse:
        """The same where a healthy machine departs from its model by `margin` RMS."""
        return replace(self, noise=hypot(self.noise, margin))


def coarse(recordings: Sequence[Recording], step: float) -> Coarse | None:
    """The readings as intervals, None where their own noise blurs the steps."""
    if step <= 0.0:
        return None
    noise = flicker(recordings, step)
    return Coarse(step, noise) if noise < _SHARP * step else None


def flicker(recordings: Sequence[Recording], step: float) -> float:
    """Noise of a reading by how often it leaves a code and comes back at once, in the reading's unit.

    White noise of a small sigma makes two readings differ, of a stem at any place in the step, with probability
    2 sigma / (sqrt(pi) step).
    """
    changed, rows = 0, 0
    for recording in recordings:
        y = recording.position[np.isfinite(recording.position)]
        at = np.flatnonzero(np.diff(y) != 0.0)
        way = np.sign(np.diff(y)[at])
        back = (np.diff(at) <= _SOON) & (way[1:] != way[:-1])
        both = np.append(back, False) | np.insert(back, 0, False)
        changed, rows = changed + int(np.count_nonzero(both)), rows + y.size
    return 0.5 * sqrt(np.pi) * step * changed / max(rows, 1)
