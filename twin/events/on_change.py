"""Readings that are reported only when they have changed enough: "change of value" of building and field buses.

Such a reading repeats, like that of a slow converter, but no change of it is smaller than the band, however slowly the
stem goes, and most are little larger. Any other reading that is not in coarse steps changes by little as often as by
somewhat more: of n changes up to twice the least one, about half would be smaller than it.
Source: Miskowicz, "Send-on-delta concept: an event-based data reporting strategy", Sensors 6 (2006) 49.
"""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.diagnosis import Estimate
from twin.events.evidence import Evidence, nothing

#: Changes up to twice the least one that make chance impossible (2^-n), and the lattice steps that a band must have.
_ENOUGH, _STEPS = 30, 3.0


def on_change(reading: FloatArray, step: float | None, unit: str, effect: str = "sensor_quantization") -> Evidence:
    """Evidence that a reading is reported on change; `step`: its lattice spacing, if any. Estimates: `band`."""
    y = reading[np.isfinite(reading)]
    changes = np.abs(np.diff(y))
    changes = changes[changes > 0.0]
    if changes.size < _ENOUGH:
        return nothing(effect, f"fewer than {_ENOUGH} changes of the reading")
    band = float(changes.min())
    if band <= _STEPS * (step or 0.0):
        return nothing(effect, "the reading changes by its resolution")
    small = int(np.count_nonzero(changes <= 2.0 * band))
    if small < _ENOUGH:
        return nothing(effect, "most changes are far larger than the least one")
    estimates = {"band": Estimate(band, (band * (1.0 - 3.0 / small), band), unit)}
    return Evidence(effect, small * float(np.log(2.0)), float(0.5**small), estimates)
