"""The E/P converter one row at a time: the compiled passes of `twin/kernels/ep.py` with the state between the rows."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from logs.recording import FloatArray
from twin.kernels.booster import booster_pass
from twin.kernels.bounded import follow_bounded
from twin.kernels.ep import (
    _mean_command,
    _mixed,
    _slewed,
    boosted,
    bounded,
    clock,
    dead_times_s,
    latest,
    through_ports,
)
from twin.kernels.ep_slots import (
    EP_AIR,
    EP_AMBIENT,
    EP_ATMOSPHERE,
    EP_BAND,
    EP_BAND_MODE,
    EP_CYCLE_S,
    EP_GAIN,
    EP_MIXED_S,
    EP_RINGS_S,
    EP_SLEW,
    EP_STROKE,
    EP_ZERO,
)
from twin.kernels.follow import follow
from twin.kernels.held import banded, held_at_first
from twin.kernels.polled import polled
from twin.kernels.ringing import ringing_pass
from twin.kernels.slots import FOREVER
from twin.kernels.stroke import struck
from twin.kernels.supply import cut, supplied, supply, zero


class Converter:
    """Command in, pressure out. `time_s`, `command`: the first row; `p0`: the pressure there."""

    def __init__(self, c: FloatArray, time_s: float, command: float, p0: float) -> None:
        self._c = c = through_ports(c)
        self.pressure = p0
        hold, start = bool(c[EP_BAND_MODE] == 1.0), (p0 - c[EP_ZERO]) / c[EP_GAIN]
        self._held = held_at_first(command, float(c[EP_BAND]), hold, float(start))
        self._rows: deque[tuple[float, float]] = deque([(time_s, command)])
        self._mixed = self._seen = command
        self._began_s = time_s
        self._bounded = bounded(c)
        self._aim, self._ringing = p0, np.array([p0, 0.0])
        self._bound = np.zeros(2)
        self._booster = np.array([p0, p0, 0.0]) if boosted(c) else None
        self._plain, self._filled = p0, math.nan  # the pressure but for the stroke; see `struck`

    def advance(self, time_s: FloatArray, offsets: np.ndarray, command: float, stem: FloatArray) -> FloatArray:
        """Pressure on the fine points of the row, shape (steps + 1,); `command` was in force over the row.

        `stem`: where it is at these points, or of size 1.
        """
        goal = self._goal(time_s, offsets, command)
        out = np.empty(int(offsets[1]) + 1)
        highest = cut(self._c, time_s, offsets, self._began_s)
        if self._booster is not None:
            booster_pass(time_s, offsets, goal, stem, self._c, highest, self._booster, out)
        elif self._bounded:
            follow_bounded(time_s, offsets, goal, self._c, highest, self._plain, self._bound, out)
        else:
            follow(time_s, offsets, goal, self._c, self._plain, out)
        self._plain = float(out[-1])
        if self._c[EP_STROKE] != 0.0:
            filled = float(stem[0]) if math.isnan(self._filled) else self._filled
            taken, self._filled = struck(time_s, offsets, np.broadcast_to(stem, out.shape), self._c, filled)
            out -= taken
        self.pressure = float(out[-1])
        return out

    def swept(self, further: float, stem: float) -> float:
        """The pressure now that the stem is at `stem`, `further` than it was said to go in the last row."""
        if self._booster is not None:
            absolute = self.pressure - self._c[EP_AMBIENT] + self._c[EP_ATMOSPHERE]
            room = 1.0 + self._c[EP_AIR] * max(stem, 0.0)
            self._booster[0] -= self._c[EP_AIR] * absolute * further / room
            self.pressure = float(self._booster[0])
        self.pressure -= self._c[EP_STROKE] * further
        return self.pressure

    def _goal(self, time_s: FloatArray, offsets: np.ndarray, command: float) -> FloatArray:
        c = self._c
        goal = np.array([command, command])
        if dead := dead_times_s(c):
            self._rows.append((float(time_s[1]), command))
            self._forget(float(time_s[0]) - max(dead))
            goal = latest(c, [self._delayed(time_s, offsets, one_s) for one_s in dead])
        if c[EP_MIXED_S] > 0.0:
            source, goal = goal, np.empty(int(offsets[1]) + 1)
            self._mixed = _mixed(time_s, source, offsets, float(c[EP_MIXED_S]), self._mixed, goal)
        if c[EP_CYCLE_S] > 0.0:
            source, goal = goal, np.empty(int(offsets[1]) + 1)
            self._seen = polled(time_s, source, offsets, clock(c, self._began_s), self._seen, goal)
        if c[EP_BAND_MODE] in (1.0, 2.0):
            source, goal = goal, np.empty(goal.size)
            banded(source, c[EP_BAND], bool(c[EP_BAND_MODE] == 1.0), self._held, goal)
            self._held = float(goal[-1])
        most = supply(c, time_s, offsets, goal.size, self._began_s)
        goal = supplied(zero(c, time_s, offsets, goal.size, self._began_s) + c[EP_GAIN] * goal, most, c)
        if c[EP_SLEW] < FOREVER:
            source, goal = goal, np.empty(int(offsets[1]) + 1)
            self._aim = _slewed(time_s, source, offsets, float(c[EP_SLEW]), self._aim, goal)
        if c[EP_RINGS_S] > 0.0:
            source, goal = goal, np.empty(int(offsets[1]) + 1)
            ringing_pass(time_s, offsets, source, c, self._ringing, goal)
        return goal

    def _forget(self, before_s: float) -> None:
        """Forgets the commands that no step can need again."""
        while len(self._rows) > 2 and self._rows[1][0] <= before_s:
            self._rows.popleft()

    def _delayed(self, time_s: FloatArray, offsets: np.ndarray, dead_s: float) -> FloatArray:
        """The commands of a dead time ago, mean over each fine step."""
        times, commands = (np.array(column) for column in zip(*self._rows, strict=True))
        steps = int(offsets[1])
        step_s = (time_s[1] - time_s[0]) / steps
        goal, j, begin = np.empty(steps + 1), 0, float(time_s[0]) - dead_s
        goal[0] = commands[-1]
        for f in range(1, steps + 1):
            goal[f], j = _mean_command(times, commands, begin, begin + step_s, j)
            begin += step_s
        return goal
