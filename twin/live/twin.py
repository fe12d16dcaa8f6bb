"""The model beside the bench: told each row's command, it says what the row's readings should have been.

Exactly what `twin/replay/simulate.py` says of the whole record afterwards, because the same compiled passes run here
with their state carried from row to row. It sees no reading but the first.
"""

from __future__ import annotations

import math

import numpy as np

from twin.kernels.sensor_slots import S_BAND, S_SEEN
from twin.kernels.valve_slots import V_REMEMBERS, stem_stops
from twin.model.plant import Plant, core_at, picked_up, pulled_stem
from twin.replay.chain import Chain
from twin.replay.sensor import Sensor
from twin.replay.simulate import Start, step_for

_MOST_STEPS = 10_000


class LiveTwin:
    """One model through one run. Units are the model's.

    `duration_s` is how long the run will take: effects that happen at a share of a recording refer to it.
    """

    def __init__(
        self, plant: Plant, time_s: float, command: float, start: Start, duration_s: float, step_s: float | None = None
    ) -> None:
        c = plant.coefficients(duration_s)
        c.valve[V_REMEMBERS] = start.remembers
        self._as_seen, self._band = bool(c.sensor[S_SEEN]), float(c.sensor[S_BAND]) or -1.0
        self._step_s = step_s or step_for(plant.design)
        self._time_s = time_s
        self._chain = Chain(c, time_s, command, start.pressure, (start.position, start.play))
        low, high = stem_stops(c.valve)
        self._coefficients = c
        seen = min(max(start.position, low), high) + picked_up(c, start.pressure)
        self._sensor = Sensor(c.sensor, time_s, seen, start.core)
        self.pressure = start.pressure
        self.position = self._sensor.first

    @classmethod
    def at_rest(
        cls, plant: Plant, time_s: float, command: float, reading: float, pressure: float | None, duration_s: float
    ) -> LiveTwin:
        """The model at rest where the first readings show the valve; without a pressure, at the command."""
        c = plant.coefficients(duration_s)
        known = command if pressure is None or not math.isfinite(pressure) else pressure
        core = core_at(c, reading)
        stem = pulled_stem(c, core, known)
        return cls(plant, time_s, command, Start(known, stem, stem, core), duration_s)

    def step(self, time_s: float, command: float, fresh: bool | None = None) -> tuple[float, float]:
        """Pressure and reading predicted at `time_s`; `command` was in force since the row before.

        A model whose readings are held as they are seen to be keeps its own while the valve's is not `fresh`;
        where nobody knows (None) one that is reported on change goes by its band.

        A row that is not later than the one before changes nothing.
        """
        if time_s <= self._time_s:
            return self.pressure, self.position
        ends = np.array([self._time_s, time_s])
        steps = min(max(math.ceil((time_s - self._time_s) / self._step_s - 1e-9), 1), _MOST_STEPS)
        pressure, stem = self._chain.advance(ends, steps, command)
        offsets = np.array([0, steps], dtype=np.int64)
        position = self._sensor.advance(ends, offsets, stem + picked_up(self._coefficients, pressure))
        if fresh is None:
            fresh = not abs(position - self.position) <= self._band
        self.position = position if fresh or not self._as_seen else self.position
        self.pressure = float(pressure[-1])
        self._time_s = time_s
        return self.pressure, self.position
