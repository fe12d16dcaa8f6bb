"""How a coarse reading rounds: to the nearest step, or always down, which is half a step of zero error.

A converter that lacks codes reads what belongs to them as the code below or above, which is an error of the zero too.
Both are no fault of calibration besides; the zero error is put into the base model where the record fits it clearly
better. Where the stem rests at a stop tells it best: there it is, whatever else is wrong with the valve. Missing codes
show all along the travel, and not at a stop; sharp steps beside which the stop lies read it as one of two codes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from logs.recording import DataNote, FloatArray, Recording
from twin.fit.channel import Channel, chain_channel
from twin.fit.trial import make_trial
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.noise.blurred import resultant
from twin.noise.lattice import missing_codes, rounding_bias
from twin.record.sensing import Sensing
from twin.search.candidates import ROUNDS_BY

_STEP_S = 0.1
#: How much smaller the squared error has to be; or how near, in half steps, the mean error to half a step.
_CLEARLY = 0.8
_NEARLY = 0.25
#: Rows at a stop, within so many steps of it in model and reading, from which the stops alone decide.
_ENOUGH, _AT_STOP = 50, 1.5
#: Codes lie beside whole steps from so many steps on.
_BESIDE = 0.1


def rounding_down(recordings: Sequence[Recording], plant: Plant, sensing: Sensing) -> tuple[Inserted, ...]:
    """Half a step of zero error, or what missing codes make of it, one way or the other.

    Nothing where the reading is fine or rounds to the nearest.
    """
    if "sensor_quantization" not in sensing.accepted or sensing.band > 0.0:
        return ()
    trials = [make_trial(r, _STEP_S, bad) for r, bad in zip(recordings, sensing.bad_rows, strict=True)]
    channel = chain_channel(trials, 1.0)
    form = effect(ROUNDS_BY).form("zero")
    lacking = rounding_bias(np.concatenate([r.position for r in recordings]), sensing.step)
    offs_in = [s * sensing.step for s in (0.0, -0.5, 0.5, -lacking, lacking)][: 5 if lacking > 0.0 else 3]
    options = [(Inserted(ROUNDS_BY, form, (off_in,)),) if off_in else () for off_in in offs_in]
    beside = sensing.sharp and _beside_zero(recordings, sensing.step)
    stops = _telling_rows(channel, plant, sensing.step) if lacking == 0.0 else []
    if stops:
        # the model of another zero would start elsewhere, and stay there as long as the pressure lets it
        error = channel.residuals(plant)
        at = [_at_stops([error[rows] - off_in for rows in stops], beside, sensing.step) for off_in in offs_in]
        told = _told(at, sensing.step, means=not beside)
        if beside or not _between(at, told, sensing.step):
            return options[told]
    whole = [channel.residuals(Plant(plant.design, (*plant.inserted, *o)))[channel.use] for o in options]
    errors = whole if lacking > 0.0 else [_beyond(e, 0.5 * sensing.step) for e in whole]
    return options[_told(errors, sensing.step, means=lacking > 0.0)]


def _told(errors: Sequence[FloatArray], step: float, means: bool) -> int:
    """Which of the options is the case whose errors these are: the first, unless another is clearly better.

    `means`: whether a mean error of next to nothing is enough.
    """
    misfits = [float(np.mean(e**2)) for e in errors]
    best = min(range(len(misfits)), key=lambda k: misfits[k])
    near = means and _off(errors[best], step) < _NEARLY
    return best if near or misfits[best] < _CLEARLY * misfits[0] else 0


def _between(errors: Sequence[FloatArray], told: int, step: float) -> bool:
    """Whether what was read lies between the first and another: a stop that is left again at once says neither."""
    first, *others = (_off(e, step) for e in errors)
    return _off(errors[told], step) >= _NEARLY and first < 1.0 > min(others)


def _off(error: FloatArray, step: float) -> float:
    """The mean error in half steps."""
    return abs(float(np.mean(error))) / (0.5 * step)


def _at_stops(errors: Sequence[FloatArray], beside: bool, step: float) -> FloatArray:
    """What the rows at each stop are off by in the mean; with codes beside the stops, by what rounding cannot make."""
    return _beyond(np.concatenate(errors), 0.5 * step) if beside else np.array([np.mean(e) for e in errors])


def _beside_zero(recordings: Sequence[Recording], step: float) -> bool:
    """Whether the codes lie beside zero and all whole steps from there."""
    positions = np.concatenate([r.position[np.isfinite(r.position)] for r in recordings])
    return abs(float(np.angle(resultant(positions, step)))) > 2.0 * np.pi * _BESIDE


def _beyond(error: FloatArray, half: float) -> FloatArray:
    """What is left of errors that rounding alone may make as large as `half`.

    A stem that rests at few places has rounding errors of any mean; none is larger than half a step.
    """
    return np.asarray(np.maximum(np.abs(error) - half, 0.0))


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
    """For each stop that was visited long enough, the rows at which model and reading are there."""
    model, near = channel.prediction(plant), _AT_STOP * step
    groups = []
    for stop in (0.0, plant.design.travel):
        rows = channel.use & (np.abs(model - stop) < 0.1 * near) & (np.abs(channel.measured - stop) < near)
        if np.count_nonzero(rows) >= _ENOUGH:
            groups.append(rows)
    return groups
