"""What the updated model predicts for the closed loop, in the operator's terms, against the recorded closed loop.

The record's controller is made again from its start document and closed around the model, which has to follow the same
targets. Where the record does not say which controller it was, its command is replayed instead: that shows what the
model makes of the same commands, and says so.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from control.controller import Controller, make_controller
from control.design import DesignModel
from control.metrics import limit_cycle
from control.tracking import judge
from hal.errors import BadInput
from hal.sample import Reading, Sample
from logs.recording import FloatArray, Recording
from twin.live.twin import LiveTwin
from twin.model.plant import Plant
from twin.replay.simulate import simulate_recording

#: A target counts as a hold when it stands still for so long [s], and has so many readings.
_SHORTEST_HOLD_S = 5.0
_FEWEST_READINGS = 8
#: Rows of all records together of which the loop is closed again; a tick of the model takes some 50 us.
_MOST_ROWS = 100_000


@dataclass(frozen=True, slots=True)
class Loop:
    """Closed loops in figures: percent of travel and seconds. `settled_s`: of every hold, None where it never did."""

    steady_error: float
    limit_cycle: float
    settled_s: tuple[float | None, ...]

    @property
    def never_settled(self) -> int:
        return self.settled_s.count(None)


def closed_loop(recordings: Sequence[Recording], plant: Plant) -> dict[str, object]:
    """The figures of the recordings with targets, as recorded and as `plant` predicts them; {} without any.

    `settling_s` is the median over the holds that settle in both: other holds would be another question.
    """
    looped = [r for r in recordings if r.target is not None and holds(r)]
    if not looped:
        return {}
    rows = accumulate(r.n for r in looped)
    used = [r for k, (r, so_far) in enumerate(zip(looped, rows, strict=True)) if k == 0 or so_far <= _MOST_ROWS]
    how: dict[str, None] = {}
    recorded, predicted = [], []
    for recording in used:
        controller = _controller(recording)
        model = _replayed(recording, plant, controller) if controller else simulate_recording(plant, recording)[1]
        how["the record's own controller around the model" if controller else "the recorded command replayed"] = None
        seen = np.isfinite(recording.position)
        recorded.append(judge_loop(recording, recording.position, plant.design.travel))
        predicted.append(judge_loop(recording, np.where(seen, model, np.nan), plant.design.travel))
    loops = {"recorded": _together(recorded), "predicted": _together(predicted)}
    both = [pair for pair in zip(*(loop.settled_s for loop in loops.values()), strict=True) if None not in pair]
    medians = np.median(np.array(both, dtype=np.float64), axis=0).tolist() if both else [None, None]
    return {
        "predicted_from": "; ".join(how),
        "records": [r.name for r in used],
        "holds": len(loops["recorded"].settled_s),
        "steady_error_percent_of_travel": {name: loop.steady_error for name, loop in loops.items()},
        "settling_s": dict(zip(loops, medians, strict=True)),
        "settled_in_both": len(both),
        "never_settled": {name: loop.never_settled for name, loop in loops.items()},
        "limit_cycle_percent_of_travel": {name: loop.limit_cycle for name, loop in loops.items()},
    }


def _together(loops: Sequence[Loop]) -> Loop:
    """The worst of several loops, with all their holds."""
    return Loop(
        steady_error=max(one.steady_error for one in loops),
        limit_cycle=max(one.limit_cycle for one in loops),
        settled_s=tuple(s for one in loops for s in one.settled_s),
    )


def holds(recording: Recording) -> list[slice]:
    """The rows of every stretch with one target, at least 5 s long."""
    assert recording.target is not None
    target = np.nan_to_num(recording.target, nan=np.inf)
    edges = np.flatnonzero(target[1:] != target[:-1]) + 1
    ends = [0, *edges.tolist(), recording.n]
    parts = [slice(a, b) for a, b in pairwise(ends) if np.isfinite(target[a])]
    time_s = recording.time_s
    return [part for part in parts if time_s[part.stop - 1] - time_s[part.start] >= _SHORTEST_HOLD_S]


def judge_loop(recording: Recording, position: FloatArray, travel: float) -> Loop:
    """Worst steady error (mean over the last quarter) and worst limit cycle of all holds, and when each one settled."""
    assert recording.target is not None
    results, cycles = [], []
    for part in holds(recording):
        seen = np.isfinite(position[part])
        if np.count_nonzero(seen) < _FEWEST_READINGS:
            continue
        time_s, x = recording.time_s[part][seen], position[part][seen]
        target = float(recording.target[part][0])
        results.append(judge(time_s, x, target, travel))
        error = 100.0 * (x - target) / travel
        cycles.append(limit_cycle(_smooth(error[error.size // 2 :])))
    return Loop(
        steady_error=max((100.0 * abs(r.final_error_in) / travel for r in results), default=0.0),
        limit_cycle=max(cycles, default=0.0),
        settled_s=tuple(r.settled_s for r in results),
    )


def _smooth(values: FloatArray, rows: int = 5) -> FloatArray:
    """Running mean: noise is no limit cycle."""
    if values.size < 2 * rows:
        return values
    return np.convolve(values, np.full(rows, 1.0 / rows), mode="valid")


def _replayed(recording: Recording, plant: Plant, controller: Controller[Any]) -> FloatArray:
    """Position at the rows when the controller drives the model; what it decides on a row is in force in the next.

    Where no target is known nobody closes the loop: the recorded command goes on, and the controller takes over anew.
    """
    assert recording.target is not None
    first = float(recording.position[np.flatnonzero(np.isfinite(recording.position))[0]])
    pressure = None if recording.pressure is None else float(recording.pressure[0])
    time_s, targets, commands = (a.tolist() for a in (recording.time_s, recording.target, recording.command))
    # a tick writes what was decided a tick ago and then reads; what it wrote holds until the next tick
    in_force = sent = commands[0]
    twin = LiveTwin.at_rest(plant, time_s[0], in_force, first, pressure, recording.duration_s)
    out: FloatArray = np.empty(recording.n)
    state: Any = None
    for k, now_s in enumerate(time_s):
        p, out[k] = twin.step(now_s, in_force)
        read = None if pressure is None else Reading(p, now_s, 0.0)
        sample = Sample(now_s, sent, Reading(float(out[k]), now_s, 0.0), read)
        in_force = sent
        if math.isfinite(targets[k]):
            state = controller.initial(sample, targets[k]) if state is None else state
            state, sent = controller.step(state, sample, targets[k], recording.period_s)
        else:
            state, sent = None, commands[min(k + 2, recording.n - 1)]
    return out


def _controller(recording: Recording) -> Controller[Any] | None:
    """The controller that the run's start document names; None for a stranger's file or an unknown controller."""
    run = recording.meta.get("run")
    named = run.get("controller") if isinstance(run, Mapping) else None
    numbers = run.get("design") if isinstance(run, Mapping) else None
    if not isinstance(named, Mapping) or not isinstance(numbers, Mapping):
        return None
    known = {field.name for field in fields(DesignModel)}
    try:
        design = DesignModel(**{key: value for key, value in numbers.items() if key in known})
        return make_controller(str(named.get("name")), design, **dict(named.get("settings") or {}))
    except (BadInput, TypeError):
        return None
