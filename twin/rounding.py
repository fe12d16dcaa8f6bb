"""How a coarse reading rounds: to the nearest step, or always down, which is half a step of zero error.

A converter that lacks codes reads what belongs to them as the code below or above, which is an error of the zero too.
Both are no fault of calibration besides; the zero error is put into the base model where the record fits it clearly
better. Where the stem rests at a stop tells it best: there it is, whatever else is wrong with the valve. Missing codes
show all along the travel, and not at a stop.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from logs.recording import DataNote, Recording
from twin.catalog import effect
from twin.fit.channel import Channel, chain_channel
from twin.fit.trial import make_trial
from twin.noise.lattice import missing_codes, rounding_bias
from twin.plant import Inserted, Plant
from twin.sensing import Sensing

_STEP_S = 0.1
#: How much smaller the squared error has to be; or how near, in half steps, the mean error to half a step.
_CLEARLY = 0.8
_NEARLY = 0.25
#: Rows at a stop, within so many steps of it in model and reading, from which the stops alone decide.
_ENOUGH, _AT_STOP = 50, 1.5


def rounding_down(recordings: Sequence[Recording], plant: Plant, sensing: Sensing) -> tuple[Inserted, ...]:
    """Half a step of zero error, or what missing codes make of it, one way or the other.

    Nothing where the reading is fine or rounds to the nearest.
    """
    if "sensor_quantization" not in sensing.accepted:
        return ()
    trials = [make_trial(r, _STEP_S, bad) for r, bad in zip(recordings, sensing.bad_rows, strict=True)]
    channel = chain_channel(trials, 1.0)
    form = effect("lvdt_calibration").form("zero")
    lacking = rounding_bias(np.concatenate([r.position for r in recordings]), sensing.step)
    groups = [channel.use] if lacking > 0.0 else _telling_rows(channel, plant, sensing.step)
    off = [s for s in (-0.5, 0.5, -lacking, lacking) if s != 0.0]
    options = [(), *((Inserted("lvdt_calibration", form, (s * sensing.step,)),) for s in off)]
    errors = [channel.residuals(Plant(plant.design, (*plant.inserted, *o))) for o in options]
    misfits = [float(np.mean([np.mean(e[rows] ** 2) for rows in groups])) for e in errors]
    best = min(range(len(options)), key=lambda k: misfits[k])
    near = abs(float(np.mean([np.mean(errors[best][rows]) for rows in groups]))) < 0.5 * _NEARLY * sensing.step
    return options[best] if near or misfits[best] < _CLEARLY * misfits[0] else ()


def lacking_codes(recordings: Sequence[Recording], sensing: Sensing) -> list[DataNote]:
    """A note on each recording whose readings lack codes."""
    notes = []
    for recording in recordings if sensing.uneven > 1.0 else ():
        count, of = missing_codes(recording.position, sensing.step)
        if count:
            what = f"{recording.name}: {count} of {of} codes of the position never occur, a converter that lacks codes"
            notes.append(DataNote(what, "counted as a coarser reading", recording.n))
    return notes


def _telling_rows(channel: Channel, plant: Plant, step: float) -> list[npt.NDArray[np.bool_]]:
    """For each stop that was visited long enough, the rows at which model and reading are there; else all."""
    model, near = channel.prediction(plant), _AT_STOP * step
    groups = []
    for stop in (0.0, plant.design.travel):
        rows = channel.use & (np.abs(model - stop) < 0.1 * near) & (np.abs(channel.measured - stop) < near)
        if np.count_nonzero(rows) >= _ENOUGH:
            groups.append(rows)
    return groups or [channel.use]
