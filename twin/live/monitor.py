"""Watches a run row by row: what the model says, how far the reading is off, and whether that has become a drift."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hal.sample import Quality
from twin.live.alarm import AlarmRules, Cusum, CusumState, design_cusum
from twin.live.twin import LiveTwin
from twin.model.plant import Plant
from twin.noise.fast import fast_memory

_UNUSABLE = Quality.MISSING | Quality.SENTINEL | Quality.IMPLAUSIBLE
#: The first stretch of a run from which the noise of the reading is taken, at least so many readings [s].
_LEARN_S, _LEARN_ROWS = 20.0, 64
#: An error of the model that is forgiven is told from here on [% of travel].
_TOLD = 0.01
#: The state before the first row is unknown: settling times until the model has forgotten it.
_FORGOTTEN = 3.0


@dataclass(frozen=True, slots=True)
class Seen:
    """One row's outcome. `statistic`: +-1 is the alarm; NaN while the alarm is not armed. `say`: a change to report."""

    position: float
    residual: float
    statistic: float
    say: str = ""


class Monitor:
    """One run against one model, whose units are those of the rows."""

    def __init__(self, plant: Plant, unit: str, duration_s: float, rules: AlarmRules | None = None) -> None:
        self._plant = plant
        self._unit = unit
        self._duration_s = duration_s
        self._rules = rules or AlarmRules()
        self._twin: LiveTwin | None = None
        self._origin_s = 0.0
        self._last = math.nan
        self._readings: list[float] = []
        self.cusum: Cusum | None = None
        self._state = CusumState()
        self.alarmed = False
        self.alarms = 0

    def warm_up(self) -> None:
        """Loads the compiled passes of this model, which takes a second the first time, before the run begins."""
        twin = LiveTwin.at_rest(self._plant, 0.0, self._plant.design.a2, 0.0, None, self._duration_s)
        for tick in range(1, 5):
            twin.step(0.1 * tick, self._plant.design.a1)

    def see(self, row: Mapping[str, float]) -> Seen:
        """Takes one row of the record: `time_s`, `command_UNIT`, `position_in`, and pressure and quality if any."""
        time_s, command = row["time_s"], row[f"command_{self._unit}"]
        reading = _usable(row)
        if self._twin is None:
            if not math.isfinite(reading):
                return Seen(math.nan, math.nan, math.nan)
            pressure = row.get("pressure_psi") if self._unit == "psi" else None
            self._twin = LiveTwin.at_rest(self._plant, time_s, command, reading, pressure, self._duration_s)
            self._origin_s = time_s
        _, predicted = self._twin.step(time_s, command, fresh=reading != self._last)
        self._last = reading
        residual = reading - predicted
        if self.cusum is None:
            self._learn(time_s, reading)
            return Seen(predicted, residual, math.nan)
        self._state = self.cusum.step(self._state, residual, time_s)
        statistic = self.cusum.statistic(self._state)
        return Seen(predicted, residual, statistic, self._change(statistic, residual, time_s))

    def _learn(self, time_s: float, reading: float) -> None:
        """Takes the noise from the first stretch, once the model has forgotten its start, and arms the alarm."""
        if math.isfinite(reading):
            self._readings.append(reading)
        d = self._plant.design
        wait_s = max(_LEARN_S, _FORGOTTEN * (d.tau_s + d.ep_tau_s))
        if time_s - self._origin_s < wait_s or len(self._readings) < _LEARN_ROWS:
            return
        sigma, phi = fast_memory(np.array(self._readings))
        period_s = (time_s - self._origin_s) / len(self._readings)
        shift = self._rules.shift * d.travel
        self.cusum = design_cusum(shift, max(sigma, 1e-6 * d.travel), min(max(phi, 0.0), 0.9), period_s, self._rules)

    def _change(self, statistic: float, residual: float, time_s: float) -> str:
        """The sentence for an alarm that begins or ends."""
        if not self.alarmed and abs(statistic) >= 1.0:
            self.alarmed = True
            self.alarms += 1
            since_s = self._state.since_high_s if statistic > 0.0 else self._state.since_low_s
            side = "above" if statistic > 0.0 else "below"
            share = 100.0 * abs(residual) / self._plant.design.travel
            return (
                f"twin: the valve has left its model at about {since_s:.0f} s: the reading is {side} the prediction, "
                f"now by {share:.2g} % of travel ({self._promise()})"
            )
        if self.alarmed and abs(statistic) < 0.1:
            self.alarmed = False
            return f"twin: the valve is back with its model at {time_s:.0f} s"
        return ""

    def _promise(self) -> str:
        """How rare a false alarm is, and for which model: one that is further off alarms, and should."""
        forgiven = 0.0 if self.cusum is None else 100.0 * self.cusum.forgives / self._plant.design.travel
        right = (
            f"while the model itself is off by less than {forgiven:.2g} %" if forgiven >= _TOLD else "for a true model"
        )
        return f"CUSUM; a false alarm comes once in {self._rules.false_alarm_s / 3600.0:g} h or less often {right}"


def _usable(row: Mapping[str, float]) -> float:
    """The row's position reading, NaN where its quality forbids to use it."""
    quality = row.get("quality", 0.0)
    if math.isfinite(quality) and int(quality) & int(_UNUSABLE):
        return math.nan
    return row.get("position_in", math.nan)
