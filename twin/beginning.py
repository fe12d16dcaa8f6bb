"""What a recording tells of the state before its first row, and how long what it does not tell is felt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from logs.recording import Recording
from twin.begun import Begun
from twin.plant import Plant
from twin.simulate import Start, moving_to, remembers, simulate_recording, start_of
from twin.timegrid import TimeGrid

#: Share of travel by which two starts differ that are told apart, and the most of a recording that they may cost.
_APART, _MOST = 2e-4, 0.5


def beginning(plant: Plant, recording: Recording, grid: TimeGrid) -> Begun:
    """How a recording begins, by the design."""
    play = moving_to(plant, recording, grid)
    stays = play is None and remembers(plant, recording, grid)
    if recording.pressure is not None and np.isfinite(recording.pressure).any():
        return Begun(play, stays)
    start = start_of(plant, recording, grid)
    if start.pressure == recording.command[0]:
        return Begun(play, stays)
    return Begun(play, stays, start.pressure, _felt_s(plant, recording, start))


def _felt_s(plant: Plant, recording: Recording, start: Start) -> float:
    """How long it makes a difference that the pressure was not the first command's.

    A delay of the converter looks the same there, and may be what is to be found. Nothing where that would cost too
    much of the recording.
    """
    usual = replace(start, pressure=float(recording.command[0]))
    (_, one), (_, other) = (simulate_recording(plant, recording, start=some) for some in (start, usual))
    apart = np.flatnonzero(np.abs(one - other) > _APART * plant.design.travel)
    felt_s = float(recording.time_s[apart[-1]] - recording.time_s[0]) if apart.size else 0.0
    return felt_s if felt_s < _MOST * recording.duration_s else 0.0
