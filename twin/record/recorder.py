"""Steps of a reading that the recorder made, and not the gauge: a historian rounds all that it stores.

A gauge's resolution is what its converter makes it, seldom a round number, and says nothing of the commands. What is
stored to a tenth of a percent is a round number, and the commands beside it are stored no finer. That is no fault of
anything on the bench: it is counted as noise, and no cause.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import DataNote, FloatArray, Recording
from logs.spoken import HOUSE, Spoken, of_its_file
from twin.noise.lattice import lattice_step

#: Round numbers, and how near to one a step has to be, as a share of it.
_ROUND, _NEAR = (1.0, 2.0, 2.5, 5.0, 10.0), 2e-3
#: A recorder keeps no more than this share of travel from anybody.
_COARSEST = 0.005
#: Commands in so many times as many steps as the readings were not stored likewise.
_FINER = 4.0
#: Levels, and different changes from one to the next, of a command that nobody typed in or stepped through.
_LEVELS, _CHANGES = 30, 8


def rounded_by_recorder(recordings: Sequence[Recording], step: float, travel: float) -> bool:
    """Whether steps of the position, in its unit as `travel` is, are those to which the commands are stored, too.

    They are round in that unit, in percent of travel, or in the unit in which the file was written.
    """
    in_file = [of_its_file(each).value(step, each.position_unit) for each in recordings]
    round_one = any(_is_round(size) for size in (step, step / travel, *in_file))
    return step > 0.0 and step < _COARSEST * travel and round_one and all(_alike(r, step) for r in recordings)


def recorder_note(recordings: Sequence[Recording], step: float, spoken: Spoken = HOUSE) -> DataNote:
    """What is said of such steps, and in which units."""
    rows = sum(r.n for r in recordings)
    size = spoken.text(step, recordings[0].position_unit, 3)
    what = f"positions are stored in steps of {size}, and the commands are no finer"
    return DataNote(what, "taken for the recorder's rounding: noise, and no fault of the gauge", rows)


def _is_round(value: float) -> bool:
    if value <= 0.0:
        return False
    mantissa = value / 10.0 ** np.floor(np.log10(value))
    return any(abs(mantissa - one) < _NEAR * one for one in _ROUND)


def _alike(recording: Recording, step: float) -> bool:
    """Whether the commands of one recording go to and fro in steps about as coarse as the readings."""
    command, reading = recording.command, recording.position[np.isfinite(recording.position)]
    of_command = lattice_step(command)
    if of_command is None or np.unique(command).size < _LEVELS or reading.size == 0:
        return False
    changes = np.round(np.diff(command) / of_command)
    if np.unique(np.abs(changes[changes != 0.0])).size < _CHANGES:
        return False
    return bool(_steps(command, of_command) < _FINER * max(_steps(reading, step), 1.0))


def _steps(values: FloatArray, step: float) -> float:
    """In how many steps the values go about; their tails do not count."""
    low, high = np.percentile(values, (1.0, 99.0))
    return float((high - low) / step)
