"""The linkage and the LVDT, one step: stem position [in] -> reading [in] before noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.stranger.kernel import compiled
from bench.stranger.stem_stage import toward
from bench.stranger.valve import TRAVEL_IN, Sensor

#: Places of the sensor's state.
CORE, FIRST, SECOND, SENSOR_STATES = 0, 1, 2, 3


@compiled
def sensor_step(sensor: Sensor, state: NDArray[np.float64], stem_in: float) -> float:
    """Advances by one step and returns the reading [in]."""
    half = 0.5 * sensor.play_in
    state[CORE] = max(stem_in - half, min(stem_in + half, state[CORE]))
    part = state[CORE] / TRAVEL_IN
    curved = (
        state[CORE]
        + sensor.bow_in * 4.0 * part * (1.0 - part)
        + sensor.square_in * part * part
        + sensor.ess_in * 10.39 * part * (1.0 - part) * (1.0 - 2.0 * part)
    )
    state[FIRST] = toward(state[FIRST], sensor.gain * curved + sensor.zero_in, sensor.lag_s)
    state[SECOND] = toward(state[SECOND], state[FIRST], sensor.second_lag_s)
    return float(state[SECOND])
