"""How far a healthy machine departs from its design: the margin within which there is no gap.

No real valve is its design. Recordings of it from when nothing was wrong say by how much the design misses it anyway;
a cause then has to explain more than that. Source: equivalence testing, Schuirmann, J. Pharmacokin. Biopharm. 15 (1987)
657 (a margin stated beforehand).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hal.errors import BadInput
from logs.recording import FloatArray, Recording
from twin.events.scan import scan_events
from twin.fit.case import Margin
from twin.fit.trial import SETTLE_S
from twin.model.plant import Plant
from twin.noise.model import NoiseModel, estimate_noise
from twin.replay.simulate import simulate_recording

#: A healthy machine that its design misses by more than this share of travel is another machine.
_NO_SUCH_VALVE = 0.25


def healthy_margin(recordings: Sequence[Recording], plant: Plant) -> Margin:
    """RMS by which `plant` misses recordings of the healthy machine, less the noise of the readings, in their units.

    The first seconds do not count (what was before them is unknown), nor do false readings. Raises: `BadInput` naming a
    recording that is missed by more than a quarter of the travel: it is no healthy machine of this design.
    """
    noise = estimate_noise(recordings)
    errors = [missed(one, plant, noise) for one in recordings]
    for one, (position, _) in zip(recordings, errors, strict=True):
        off = float(np.sqrt(np.mean(position**2))) / plant.design.travel if position.size else 0.0
        if off > _NO_SUCH_VALVE:
            raise BadInput(
                f"{one.name}: the design misses this healthy recording by {100.0 * off:.0f} % of travel; "
                "give the design that belongs to the machine, or one identified from this recording, as --design"
            )
    position, pressure = np.concatenate([p for p, _ in errors]), np.concatenate([p for _, p in errors])
    known = noise.pressure.sigma if noise.pressure is not None else 0.0
    return Margin(position=_beyond(position, noise.position.sigma), pressure=_beyond(pressure, known))


def missed(recording: Recording, plant: Plant, noise: NoiseModel) -> tuple[FloatArray, FloatArray]:
    """Errors of position and pressure in the rows that count; no pressure, no rows of it."""
    pressure, position = simulate_recording(plant, recording)
    late = recording.time_s - recording.time_s[0] >= SETTLE_S
    good = late & np.isfinite(recording.position) & ~scan_events(recording, noise).false_position
    if recording.pressure is None:
        return (recording.position - position)[good], np.zeros(0)
    seen = late & np.isfinite(recording.pressure)
    return (recording.position - position)[good], (recording.pressure - pressure)[seen]


def _beyond(errors: FloatArray, sigma: float) -> float:
    """What the errors have beyond the noise, RMS."""
    return float(np.sqrt(max(float(np.mean(errors**2)) - sigma**2, 0.0))) if errors.size else 0.0
