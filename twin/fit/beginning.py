"""What a recording tells of the state before its first row, and how long what it does not tell is felt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import DataNote, Recording
from twin.fit.trial import Trial
from twin.model.plant import Plant
from twin.model.timegrid import TimeGrid
from twin.noise.coarse import Coarse
from twin.record.begun import Begun
from twin.record.under_way import under_way
from twin.replay.simulate import Start, is_measured, moving_to, remembers, simulate_recording, start_of

#: Share of travel by which two starts differ that are told apart, and the most of a recording that they may cost.
_APART, _MOST = 5e-4, 0.5
#: Share of travel by which a stem under way is elsewhere a moment later.
_ELSEWHERE = 0.1


def beginning(plant: Plant, recording: Recording, grid: TimeGrid, coarse: Coarse | None = None) -> Begun:
    """How a recording begins, by the design; a coarse reading says no more than an interval."""
    start = start_of(plant, recording, grid)
    play = moving_to(plant, recording, grid, start)
    begun = Begun(play, play is None and remembers(plant, recording, grid))
    others = [] if coarse is None else _within(plant, start, coarse.half)
    if under_way(plant.design, recording):
        others += _within(plant, start, _ELSEWHERE * plant.design.travel)
    if not is_measured(recording) and start.pressure != recording.command[0]:
        begun = replace(begun, pressure=start.pressure)
        others.append(replace(start, pressure=float(recording.command[0])))
    return replace(begun, unsure_s=_felt_s(plant, recording, start, others))


def start_notes(trials: Sequence[Trial]) -> list[DataNote]:
    """What to say of recordings whose first rows are left out for the state before them."""
    unsure = [t for t in trials if t.begun.unsure_s > 0.0]
    if not unsure:
        return []
    lost = sum(int(np.count_nonzero(t.recording.time_s - t.recording.time_s[0] < t.begun.unsure_s)) for t in unsure)
    what = f"{len(unsure)} of {len(trials)} recordings begin in a state that their first rows do not tell"
    longest_s = max(t.begun.unsure_s for t in unsure)
    return [DataNote(what, f"rows that still feel it, up to {longest_s:.0f} s of a recording, are not compared", lost)]


def _within(plant: Plant, start: Start, far: float) -> list[Start]:
    """Starts that are not told apart: where the stem stands, within so much, and where to it is on its way."""
    stems = [start.position + side * far for side in (-1.0, 1.0)]
    return [replace(start, position=x, play=w) for x in stems for w in (x, 0.0, plant.design.travel)]


def _felt_s(plant: Plant, recording: Recording, start: Start, others: Sequence[Start]) -> float:
    """How long it makes a difference which of several starts it was. Nothing where that costs too much of a recording.

    Where the pressure is a guess, a delay of the converter looks the same there, and may be what is to be found.
    """
    _, one = simulate_recording(plant, recording, start=start)
    felt_s = 0.0
    for other in others:
        apart = np.abs(simulate_recording(plant, recording, start=other)[1] - one) > _APART * plant.design.travel
        if apart.any():
            felt_s = max(felt_s, float(recording.time_s[np.flatnonzero(apart)[-1]] - recording.time_s[0]))
    return felt_s if felt_s < _MOST * recording.duration_s else 0.0
