"""The stranger's plant: the design model and whatever the valve adds, integrated in steps of a millisecond."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.stranger.ep_stage import EP_STATES, HELD, LINE_STEPS, PLAYED, PRESSURE, ep_step
from bench.stranger.kernel import STEP_S, compiled
from bench.stranger.play_stage import PLAYS
from bench.stranger.sensor_stage import SENSOR_STATES, sensor_step
from bench.stranger.stem_stage import SLOW_PSI, STEM_STATES, TUBE, stem_step
from bench.stranger.valve import (
    BAND_PSI,
    CHANNELS,
    LEAK_SHARE,
    LOCKED,
    READING_IN,
    SPRING_PSI,
    TARGET_PSI,
    Ep,
    Sensor,
    Stem,
    Valve,
)

Floats = NDArray[np.float64]


@compiled
def _row(
    chain: tuple[Ep, Stem, Sensor], states: tuple[Any, ...], command_psi: float, steps: int, weather: Floats
) -> tuple[float, float]:
    """Advances the chain by one row of `steps` and returns pressure [psi] and reading [in] at its end."""
    ep_state, line, stem_state, plays, sensor_state = states
    pressure, reading = 0.0, 0.0
    for _ in range(steps):
        pressure = ep_step(chain[0], ep_state, line, command_psi, weather[TARGET_PSI])
        acting = pressure * (1.0 - weather[LEAK_SHARE]) - weather[SPRING_PSI]
        stem_in = stem_step(chain[1], stem_state, plays, acting, weather[BAND_PSI], weather[LOCKED] > 0.5)
        reading = sensor_step(chain[2], sensor_state, stem_in)
    return pressure, reading + weather[READING_IN]


@compiled
def _rows(
    chain: tuple[Ep, Stem, Sensor], states: tuple[Any, ...], commands_psi: Floats, steps: Any, weather: Floats
) -> tuple[Floats, Floats]:
    """All rows of an open-loop sequence."""
    pressure, reading = np.empty(commands_psi.size), np.empty(commands_psi.size)
    for row in range(commands_psi.size):
        pressure[row], reading[row] = _row(chain, states, commands_psi[row], steps[row], weather[row])
    return pressure, reading


def weather_table(valve: Valve, time_s: Floats) -> Floats:
    """What happens to the valve at every row: shape (rows, CHANNELS), in each channel's unit."""
    table = np.zeros((time_s.size, CHANNELS))
    for channel, course in valve.weather:
        table[:, channel] += course(time_s)
    return table


def clock_s(steps: NDArray[np.int64]) -> Floats:
    """Time [s] at the end of every row, shape (rows,)."""
    return np.asarray(np.cumsum(steps) * STEP_S, dtype=np.float64)


class Plant:
    """One valve at rest, fully open, under the first command [psi]; it remembers its state from call to call."""

    def __init__(self, valve: Valve, first_psi: float) -> None:
        self._chain = (valve.ep, valve.stem, valve.sensor)
        ep_state, stem_state = np.zeros(EP_STATES), np.zeros(STEM_STATES)
        ep_state[[PRESSURE, HELD, PLAYED]] = first_psi
        stem_state[[TUBE, SLOW_PSI]] = first_psi
        line = np.full(LINE_STEPS, first_psi)
        self._states = (ep_state, line, stem_state, np.zeros(PLAYS), np.zeros(SENSOR_STATES))

    def row(self, command_psi: float, steps: int, weather: Floats) -> tuple[float, float]:
        """Pressure [psi] and reading [in] at the end of a row of `steps`; `weather` has shape (CHANNELS,)."""
        return _row(self._chain, self._states, command_psi, steps, weather)

    def rows(self, commands_psi: Floats, steps: NDArray[np.int64], weather: Floats) -> tuple[Floats, Floats]:
        """Pressure [psi] and reading [in] of every row, shapes (rows,); `weather` has shape (rows, CHANNELS)."""
        return _rows(self._chain, self._states, commands_psi, steps, weather)


def noise_free(valve: Valve, commands_psi: Floats, steps: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Pressure [psi] and reading [in] of an open-loop sequence without noise and without the acquisition's effects."""
    time_s = clock_s(steps)
    return Plant(valve, float(commands_psi[0])).rows(commands_psi, steps, weather_table(valve, time_s))
