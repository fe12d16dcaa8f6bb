"""Whether records can be of the valve whose numbers they would be held against: one with wrong numbers, or another one.

Whoever gives no design has the thesis's numbers for records in psi and in. A valve in other units gets its own, from
the record; one that happens to be in these is no different. It is another valve if the numbers miss it by far, if most
of what tells valves apart is far off, and if its own numbers explain it: a fault alone does not do all three.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from control.design import DesignModel
from hal.errors import BadInput
from logs.recording import Recording
from twin.model.insert import plant_of
from twin.noise.model import estimate_noise
from twin.ready.healthy import missed
from twin.record.admit import admit

#: RMS of the gap, as a share of travel, below which numbers are only wrong.
_FAR = 0.10
#: Share of that which the valve's own numbers may leave.
_LEFT = 0.2
#: How many of the numbers that tell valves apart are off by which share of themselves, at the least.
_NUMBERS, _OFF = 3, 0.25
_TELLING = ("offset", "deadband", "compliance", "tau_s", "travel")


def miss(recordings: Sequence[Recording], design: DesignModel) -> float:
    """RMS by which a design misses the positions, as a share of its travel; design and records have the same units."""
    plant, noise = plant_of(design), estimate_noise(recordings)
    errors = np.concatenate([missed(one, plant, noise)[0] for one in recordings])
    return float(np.sqrt(np.mean(errors**2))) / design.travel if errors.size else 0.0


def admitted(recordings: Sequence[Recording], design: DesignModel) -> bool:
    """Whether a diagnosis against the design would not refuse the records."""
    try:
        admit(recordings, plant_of(design), estimate_noise(recordings))
    except BadInput:
        return False
    return True


def far_off(missed: float) -> bool:
    """Whether numbers that miss a record by this share of travel may be another valve's."""
    return missed >= _FAR


def is_another(own: DesignModel, left: float, given: DesignModel, missed: float) -> bool:
    """Whether a valve with its `own` numbers, which leave the share `left`, is not the `given` one, which misses it."""
    off = [abs(getattr(own, name) / getattr(given, name) - 1.0) >= _OFF for name in _TELLING]
    return far_off(missed) and left * own.travel <= _LEFT * missed * given.travel and sum(off) >= _NUMBERS
