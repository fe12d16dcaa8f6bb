"""What a plant is compared with: a channel turns a plant into residuals in units of the noise.

Three channels, because the signals factorise: measured pressure given the command judges the E/P converter alone;
the reading given the (smoothed) measured pressure judges valve and sensor alone; without measured pressure only the
reading given the command is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray, Recording
from twin.fit.compiled import in_noise
from twin.fit.trial import Trial, concatenate
from twin.kernels.sensor_slots import S_CORE
from twin.kernels.valve_slots import V_REMEMBERS
from twin.model.plant import (
    Plant,
    core_at,
    picked_up,
    pressure_response,
    pulled_stem,
    reading_response,
    stem_at,
    stem_of,
    stem_response,
)
from twin.replay.chain import chain_response, takes_air

#: Of what the readings go through: a prediction that goes through less stays put.
_PUT = 0.02

Predict = Callable[[Plant, Trial], FloatArray]


def predict_pressure(plant: Plant, trial: Trial) -> FloatArray:
    """Pressure at the rows from the command, shape (n,)."""
    return pressure_fine(plant, trial)[trial.grid.offsets]


def pressure_fine(plant: Plant, trial: Trial) -> FloatArray:
    """Pressure on the fine grid from the command, and from the stem as it was read, should that take air."""
    c = plant.coefficients(trial.recording.duration_s, trial.place)
    stem = trial.stem if takes_air(c.ep) else None
    return pressure_response(c, trial.grid, trial.recording.command, trial.start_pressure, stem)


def predict_reading_given_pressure(plant: Plant, trial: Trial) -> FloatArray:
    """Reading at the rows from the smoothed measured pressure."""
    if trial.pressure is None:
        raise ValueError("the trial has no smoothed pressure")
    return _reading(plant, trial, trial.pressure)


def predict_reading(plant: Plant, trial: Trial) -> FloatArray:
    """Reading at the rows from the command alone: the whole chain."""
    return _reading(plant, trial, None)


def _reading(plant: Plant, trial: Trial, pressure: FloatArray | None) -> FloatArray:
    c = plant.coefficients(trial.recording.duration_s, trial.place)
    picked = picked_up(c, trial.start_pressure)
    core = core_at(c, trial.start_position - picked)
    c.sensor[S_CORE] = core
    if trial.begun.play is None:
        start = play = pulled_stem(c, core, trial.start_pressure)
    else:
        start, play = stem_of(c, core), stem_at(c, trial.begun.play - picked)
    c.valve[V_REMEMBERS] = trial.begun.remembers
    if pressure is None:
        pressure, stem = chain_response(c, trial.grid, trial.recording.command, trial.start_pressure, start, play)
    else:
        stem = stem_response(c, trial.grid, pressure, start, play)
    return reading_response(c, trial.grid, stem, pressure, trial.fresh)


@dataclass(frozen=True, slots=True)
class Channel:
    """Residuals (measured - predicted) / sigma over all trials, 0 in rows that do not count; shape (sum of n,).

    Of an error only what is larger than `half` counts: half the step of a coarse reading, which says no more.
    """

    name: str
    trials: tuple[Trial, ...]
    measured: FloatArray
    use: np.ndarray
    sigma: float
    predict: Predict
    numbers: tuple[str, ...]
    stages: tuple[str, ...]
    half: float = 0.0

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """The recordings of its trials."""
        return tuple(trial.recording for trial in self.trials)

    def prediction(self, plant: Plant) -> FloatArray:
        """Predicted signal over all trials, in its own unit."""
        return concatenate([self.predict(plant, trial) for trial in self.trials])

    def residuals(self, plant: Plant) -> FloatArray:
        """Residuals in units of the noise."""
        return in_noise(self.measured, self.prediction(plant), self.use, self.sigma, self.half)

    def stands(self, plant: Plant) -> bool:
        """Whether the prediction stays put in every trial although the readings go somewhere."""
        ends = np.cumsum([trial.recording.n for trial in self.trials])[:-1]
        trials = zip(np.split(self.measured, ends), np.split(self.use, ends), self.trials, strict=True)
        return all(
            np.ptp(self.predict(plant, trial)[use]) < _PUT * np.ptp(np.percentile(read[use], (1.0, 99.0)))
            for read, use, trial in trials
            if use.any()
        )

    @property
    def rows(self) -> int:
        """How many rows count."""
        return int(np.count_nonzero(self.use))


def pressure_channel(trials: Sequence[Trial], sigma: float) -> Channel:
    """Measured pressure given the command: the E/P converter alone."""
    measured = concatenate([_filled(t.recording.pressure, t) for t in trials])
    use = np.concatenate([t.use_p for t in trials])
    return Channel("pressure", tuple(trials), measured, use, sigma, predict_pressure, ("ep_tau",), ("ep",))


def position_channel(trials: Sequence[Trial], sigma: float) -> Channel:
    """The reading given the smoothed measured pressure: valve and sensor alone."""
    numbers = ("deadband", "offset", "compliance", "tau", "rate_limit")
    predict = predict_reading_given_pressure
    return _position(trials, sigma, "position", predict, numbers, ("actuator", "sensor"))


def chain_channel(trials: Sequence[Trial], sigma: float) -> Channel:
    """The reading given the command: the whole chain."""
    numbers = ("deadband", "offset", "compliance", "tau", "rate_limit", "ep_tau")
    return _position(trials, sigma, "chain", predict_reading, numbers, ("ep", "actuator", "sensor"))


def _position(
    trials: Sequence[Trial],
    sigma: float,
    name: str,
    predict: Predict,
    numbers: tuple[str, ...],
    stages: tuple[str, ...],
) -> Channel:
    measured = concatenate([np.nan_to_num(t.recording.position) for t in trials])
    use = np.concatenate([t.use_y for t in trials])
    return Channel(name, tuple(trials), measured, use, sigma, predict, numbers, stages)


def _filled(values: FloatArray | None, trial: Trial) -> FloatArray:
    return np.zeros(trial.recording.n) if values is None else np.nan_to_num(values)
