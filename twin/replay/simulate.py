"""Replays a recording's command through a plant: what the model says the two readings should have been."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from control.design import DesignModel
from hal.errors import BadInput
from logs.recording import FloatArray, Recording
from twin.events.refresh import freshness
from twin.kernels.sensor_slots import S_CORE, S_SEEN
from twin.kernels.valve_slots import V_REMEMBERS
from twin.model.insert import inserted_from, plant_of
from twin.model.plant import (
    Plant,
    core_at,
    pressure_response,
    pulled_stem,
    reading_at,
    reading_response,
    stem_at,
    stem_response,
)
from twin.model.timegrid import TimeGrid, make_grid
from twin.replay.chain import chain_response

__all__ = ["Start", "inserted_from", "plant_of", "simulate_recording", "start_of", "step_for"]

#: Longest and shortest fine step [s]; the longest keeps the thesis's valve within 0.01 % of travel.
_LONGEST_S, _SHORTEST_S = 0.02, 0.002
#: Rows over which the first readings are averaged, and how much better another play output must explain the start.
_FIRST_ROWS = 5
_BETTER = 0.8
#: Pressures that may have been, and by how much the log-likelihood has to gain by one of them.
_PRESSURES, _SURE = 9, 12.0
#: Share of travel that is off the target, and of it what two lags later still is where something slow holds the stem.
_OFF, _STAYS = 0.003, 0.5
#: By which lag and rate limit of a design may be wrong.
_OTHERWISE = (0.6, 0.67, 0.75, 0.83, 0.91, 1.0, 1.1, 1.2, 1.33, 1.5, 1.67)


@dataclass(frozen=True, slots=True)
class Start:
    """State before the first row: pressure, stem position, and play output (the target the stem was left with).

    `core`: where the core of a loose linkage stands; not a number: with the stem. `remembers`: see the function.
    """

    pressure: float
    position: float
    play: float
    core: float = float("nan")
    remembers: bool = False


def step_for(design: DesignModel) -> float:
    """Fine step [s] that keeps the integration error below 0.02 % of travel at any sampling period.

    The target is taken as linear within a step, which it is not while the converter settles: error ~ step^2 / lags.
    """
    settling = _LONGEST_S * np.sqrt(design.ep_tau_s / 0.30 * max(design.tau_s / 2.7, 0.05))
    return float(np.clip(min(settling, design.tau_s / 20.0), _SHORTEST_S, _LONGEST_S))


def simulate_recording(
    design: DesignModel | Plant, recording: Recording, step_s: float | None = None, start: Start | None = None
) -> tuple[FloatArray, FloatArray]:
    """Pressure and reading at the rows of `recording`, each of shape (n,), in the recording's units.

    The start pressure is the first pressure reading, or else the first command, unless the first seconds tell another;
    the stem starts at the first reading. Through a gap the command of the row after it is taken to hold. Raises:
    `BadInput` for an effect that is unknown.
    """
    plant = design if isinstance(design, Plant) else plant_of(design)
    if recording.n < 2:
        raise BadInput(f"{recording.name}: {recording.n} rows cannot be replayed; a recording needs at least 2")
    grid = make_grid(recording.time_s, step_s or step_for(plant.design))
    first = start or start_of(plant, recording, grid)
    c = plant.coefficients(recording.duration_s)
    c.sensor[S_CORE], c.valve[V_REMEMBERS] = first.core, first.remembers
    pressure, stem = chain_response(c, grid, recording.command, first.pressure, first.position, first.play)
    # a blank that is to be filled says nothing of when its readings are new
    fresh = freshness(recording) if c.sensor[S_SEEN] and np.diff(recording.position).any() else None
    return pressure[grid.offsets], reading_response(c, grid, stem, pressure, fresh)


def start_of(plant: Plant, recording: Recording, grid: TimeGrid) -> Start:
    """The state before the first row as far as the recording tells.

    At rest the stem stands at the median of the first readings and the play output with it. Where the valve was moving
    neither holds: then the first reading or a line through the first ones, with the play output that explains the
    first seconds best, is taken if it explains them clearly better.
    """
    pressure = _seen(recording.pressure, float(recording.command[0]))[0]
    middle = plant.design.compliance * (pressure - plant.design.offset)
    readings = _seen(recording.position, float(np.clip(middle, 0.0, plant.design.travel)))[:_FIRST_ROWS]
    c = plant.coefficients(recording.duration_s)
    core = core_at(c, float(np.median(readings)))
    position = pulled_stem(c, core, float(pressure))
    rest = Start(float(pressure), position, position, core)
    if not np.isfinite(recording.position).any():
        return rest
    rest = replace(rest, remembers=remembers(plant, recording, grid))
    stems = [position, stem_at(c, float(readings[0])), stem_at(c, _before(recording))]
    plays = np.linspace(0.0, plant.design.travel, 33).tolist()
    candidates = [rest, *(Start(float(pressure), x, w) for x in stems for w in (x, *plays))]
    head, cut = _head(plant, recording, grid)

    def miss(one: Start) -> float:
        return _miss(plant, head, cut, one)

    misses = [miss(one) for one in candidates]
    best = int(np.argmin(misses))
    found = rest
    if misses[best] < _BETTER * misses[0]:
        near = candidates[best]
        found = _refined(near, near.play, plays[1], lambda play: replace(near, play=play), miss)
    if is_measured(recording):
        return found
    return _pressed(found, stems, recording, miss, head.n)


def is_measured(recording: Recording) -> bool:
    """Whether there is any reading of the pressure."""
    return recording.pressure is not None and bool(np.isfinite(recording.pressure).any())


def moving_to(plant: Plant, recording: Recording, grid: TimeGrid, start: Start | None = None) -> float | None:
    """The reading towards which the valve was moving before the first row, None where it stood still.

    As a reading it holds for any gain and zero of the sensor that a hypothesis may have. It is not believed where a
    valve at rest, with another lag or rate limit, moves off as well: the design's may be wrong. `start`: as `start_of`
    says, if that is known.
    """
    start = start or start_of(plant, recording, grid)
    if start.play == start.position or _rests(plant, recording, grid, start):
        return None
    return reading_at(plant.coefficients(recording.duration_s), start.play)


def remembers(plant: Plant, recording: Recording, grid: TimeGrid) -> bool:
    """Whether the stem stands off where the pressure has it, and stays there for longer than its lag explains.

    Then something slow holds it, which had been elsewhere before the recording. A stem that lags behind a ramp stands
    off, too, all along; but so does the design's.
    """
    head, cut = _head(plant, recording, grid)
    c, start = plant.coefficients(head.duration_s), float(_seen(head.pressure, float(head.command[0]))[0])
    pressure = pressure_response(c, cut, head.command, start)
    reading = _median(head.position[:_FIRST_ROWS])
    before = reading - _rest_of(plant.design, reading, float(np.median(pressure[cut.offsets[:_FIRST_ROWS]])))
    if not abs(before) > _OFF * plant.design.travel:
        return False
    at = stem_at(c, reading)
    later = reading_response(c, cut, stem_response(c, cut, pressure, at, at), pressure)
    return _median((head.position - later)[-_FIRST_ROWS:]) / before > _STAYS


def _rest_of(d: DesignModel, reading: float, pressure: float) -> float:
    """Where the design's play would let a stem rest that is read at `reading`, at this pressure."""
    low, high = np.clip(d.compliance * (pressure - np.array([d.a1, d.a2])), 0.0, d.travel)
    return float(np.clip(reading, low, high))


def _median(values: FloatArray) -> float:
    return float(np.median(values[np.isfinite(values)])) if np.isfinite(values).any() else float("nan")


def _rests(plant: Plant, recording: Recording, grid: TimeGrid, moving: Start) -> bool:
    """Whether a start at rest explains the first seconds about as well as `moving`, with other numbers of the stem."""
    head, cut = _head(plant, recording, grid)
    rest, d = replace(moving, play=moving.position), plant.design
    others = [
        replace(plant, design=replace(d, tau_s=slower * d.tau_s, rate_limit=d.rate_limit / tighter))
        for slower in _OTHERWISE
        for tighter in _OTHERWISE
    ]
    least = min(_miss(other, head, cut, rest) for other in others)
    return _miss(plant, head, cut, moving) >= _BETTER * least


def _head(plant: Plant, recording: Recording, grid: TimeGrid) -> tuple[Recording, TimeGrid]:
    """The first two lags of a recording."""
    stop = int(np.searchsorted(recording.time_s, recording.time_s[0] + 2.0 * plant.design.tau_s)) + 2
    return recording.slice(0, stop), TimeGrid(grid.time_s[:stop], grid.offsets[:stop])


def _pressed(
    start: Start, stems: list[float], recording: Recording, miss: Callable[[Start], float], rows: int
) -> Start:
    """The start with a pressure that explains the first seconds clearly better, where none was measured.

    The command may have changed right before the first row. Any that is given later may have been given then.
    """
    pressures = np.linspace(recording.command.min(), recording.command.max(), _PRESSURES).tolist()
    candidates = [Start(p, x, w) for p in pressures for x in stems for w in {x, start.play}]
    least = min(candidates, key=miss)
    if miss(least) * max(np.exp(_SURE / rows), 1.0 / _BETTER) > miss(start):
        return start
    step = pressures[1] - pressures[0]
    return _refined(least, least.pressure, step, lambda pressure: replace(least, pressure=pressure), miss)


def _refined(
    start: Start, at: float, within: float, having: Callable[[float], Start], miss: Callable[[Start], float]
) -> Start:
    """The start `having` what explains best: a play output or a pressure, found `at` some value of a coarse grid."""
    found = minimize_scalar(
        lambda value: miss(having(float(value))),
        bounds=(at - within, at + within),
        method="bounded",
        options={"maxiter": 15},
    )
    return having(float(found.x)) if found.fun < miss(start) else start


def _seen(values: FloatArray | None, otherwise: float) -> FloatArray:
    """The readings that there are, or one value instead."""
    if values is None or not np.isfinite(values).any():
        return np.array([otherwise])
    return values[np.isfinite(values)]


def _before(recording: Recording) -> float:
    """A line through the first rows at the first: median slope of all pairs (Theil 1950); a false row is harmless."""
    rows = np.flatnonzero(np.isfinite(recording.position))[: 2 * _FIRST_ROWS]
    t, y = recording.time_s[rows] - recording.time_s[0], recording.position[rows]
    later, sooner = np.triu_indices(rows.size, 1)[::-1]
    slope = np.median((y[later] - y[sooner]) / (t[later] - t[sooner])) if rows.size > 1 else 0.0
    return float(np.median(y - slope * t))


def _miss(plant: Plant, head: Recording, grid: TimeGrid, start: Start) -> float:
    """Mean squared difference over the head, without its worst tenth, which may be false readings."""
    c = plant.coefficients(head.duration_s)
    c.sensor[S_CORE] = start.core
    pressure, stem = chain_response(c, grid, head.command, start.pressure, start.position, start.play)
    reading = reading_response(c, grid, stem, pressure)
    seen = np.isfinite(head.position)
    squares = np.sort((head.position[seen] - reading[seen]) ** 2)[: max(1, int(0.9 * np.count_nonzero(seen)))]
    return float(np.mean(squares)) if squares.size else 0.0
