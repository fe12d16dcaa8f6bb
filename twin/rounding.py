"""How a coarse reading rounds: to the nearest step, or always down, which is half a step of zero error.

The second is no fault of calibration besides; it is put into the base model where the record fits it clearly better.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import FloatArray, Recording
from twin.catalog import effect
from twin.fit.channel import chain_channel
from twin.fit.trial import make_trial
from twin.plant import Inserted, Plant
from twin.sensing import Sensing

_STEP_S = 0.1
#: How much smaller the squared error has to be; or how near, in half steps, the mean error to half a step.
_CLEARLY = 0.8
_NEARLY = 0.25


def rounding_down(recordings: Sequence[Recording], plant: Plant, sensing: Sensing) -> tuple[Inserted, ...]:
    """Half a step of zero error, one way or the other; nothing where the reading is fine or rounds to the nearest."""
    if "sensor_quantization" not in sensing.accepted:
        return ()
    form = effect("lvdt_calibration").form("zero")
    options = [(), *((Inserted("lvdt_calibration", form, (s * sensing.step,)),) for s in (-0.5, 0.5))]
    errors = [_errors(recordings, Plant(plant.design, (*plant.inserted, *o)), sensing) for o in options]
    misfits = [float(error @ error) for error in errors]
    best = min(range(3), key=lambda k: misfits[k])
    near = abs(float(np.mean(errors[best]))) < 0.5 * _NEARLY * sensing.step
    return options[best] if near or misfits[best] < _CLEARLY * misfits[0] else ()


def _errors(recordings: Sequence[Recording], plant: Plant, sensing: Sensing) -> FloatArray:
    trials = [make_trial(r, _STEP_S, bad) for r, bad in zip(recordings, sensing.bad_rows, strict=True)]
    return chain_channel(trials, 1.0).residuals(plant)
