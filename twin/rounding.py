"""How a coarse reading rounds: to the nearest step, or always down, which is half a step of zero error.

The second is no fault of calibration besides; it is put into the base model where the record fits it clearly better.
"""

from __future__ import annotations

from collections.abc import Sequence

from logs.recording import Recording
from twin.catalog import effect
from twin.fit.channel import chain_channel
from twin.fit.trial import make_trial
from twin.plant import Inserted, Plant
from twin.sensing import Sensing

_STEP_S = 0.1
#: How much smaller the squared error has to be.
_CLEARLY = 0.8


def rounding_down(recordings: Sequence[Recording], plant: Plant, sensing: Sensing) -> tuple[Inserted, ...]:
    """Half a step of zero error, one way or the other; nothing where the reading is fine or rounds to the nearest."""
    if "sensor_quantization" not in sensing.accepted:
        return ()
    form = effect("lvdt_calibration").form("zero")
    options = [(), *((Inserted("lvdt_calibration", form, (s * sensing.step,)),) for s in (-0.5, 0.5))]
    misfits = [_misfit(recordings, Plant(plant.design, (*plant.inserted, *o)), sensing) for o in options]
    best = min(range(3), key=lambda k: misfits[k])
    return options[best] if misfits[best] < _CLEARLY * misfits[0] else ()


def _misfit(recordings: Sequence[Recording], plant: Plant, sensing: Sensing) -> float:
    trials = [make_trial(r, _STEP_S, bad) for r, bad in zip(recordings, sensing.bad_rows, strict=True)]
    residuals = chain_channel(trials, 1.0).residuals(plant)
    return float(residuals @ residuals)
