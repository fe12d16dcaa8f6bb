"""The E/P converter: command steps in, pressure on the fine time grid out, as compiled passes.

First the goal (delay, ignored band, gain, zero, supply), then the lag toward it with its bounds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.active import acts
from twin.kernels.booster import booster_pass
from twin.kernels.bounded import follow_bounded
from twin.kernels.ep_slots import (
    EP_AIR,
    EP_BAND,
    EP_BAND_MODE,
    EP_CHAMBER,
    EP_CLIP,
    EP_CLOG_DOWN,
    EP_CLOG_UP,
    EP_CUT,
    EP_CYCLE_S,
    EP_DEAD_FALLS,
    EP_DEAD_S,
    EP_DRIFTS,
    EP_FULL_DOWN,
    EP_FULL_UP,
    EP_GAIN,
    EP_MIXED_S,
    EP_NOMINAL,
    EP_PORT_DOWN,
    EP_PORT_UP,
    EP_QUICK,
    EP_RATE_DOWN,
    EP_RATE_UP,
    EP_RINGS_S,
    EP_SEEN_S,
    EP_SLEW,
    EP_STROKE,
    EP_SUPPLY,
    EP_TANK,
    EP_TAU_FALL_S,
    EP_TAU_RISE_S,
    EP_WANES,
    EP_ZERO,
)
from twin.kernels.follow import follow
from twin.kernels.held import banded, held_at_first
from twin.kernels.polled import polled
from twin.kernels.ringing import ringing_pass
from twin.kernels.slots import FOREVER
from twin.kernels.stroke import struck
from twin.kernels.supply import cut, supplied, supply, zero

#: What makes the lag another one, besides a band and limits.
_OTHER_LAGS = np.array([EP_QUICK, EP_CLOG_UP, EP_CLOG_DOWN, EP_WANES])


def ep_kernel(
    time_s: FloatArray,
    command: FloatArray,
    offsets: np.ndarray,
    c: FloatArray,
    p0: float,
    stem: FloatArray | None,
    out: FloatArray,
) -> None:
    """Fills `out` (shape (offsets[-1] + 1,)) with the pressure; `offsets[i]` is the fine index of row i.

    `stem`: where it is, of the shape of `out`, for a converter that it takes air from; None: it stands still, open.
    """
    c = through_ports(c)
    goal = _goal(time_s, np.ascontiguousarray(command, dtype=np.float64), offsets, c, p0)
    highest = cut(c, time_s, offsets, time_s[0])
    if boosted(c):
        where = np.zeros(1) if stem is None else np.ascontiguousarray(stem)
        booster_pass(time_s, offsets, goal, where, c, highest, np.array([p0, p0, 0.0]), out)
    elif bounded(c):
        follow_bounded(time_s, offsets, goal, c, highest, p0, np.zeros(2), out)
    else:
        follow(time_s, offsets, goal, c, p0, out)
    if c[EP_STROKE] != 0.0 and stem is not None:
        out -= struck(time_s, offsets, np.ascontiguousarray(stem), c, float(stem[0]))[0]


def _goal(time_s: FloatArray, command: FloatArray, offsets: np.ndarray, c: FloatArray, p0: float) -> FloatArray:
    """What the lag goes to: per row where it is constant within one, else fine, shape (offsets[-1] + 1,)."""
    goal, size = command, int(offsets[-1]) + 1
    if dead := dead_times_s(c):
        goals = [np.empty(size) for _ in dead]
        for dead_s, each in zip(dead, goals, strict=True):
            _delayed(time_s, command, offsets, dead_s, each)
        goal = latest(c, goals)
    if c[EP_MIXED_S] > 0.0:
        source, goal = goal, np.empty(size)
        _mixed(time_s, source, offsets, c[EP_MIXED_S], command[0], goal)
    if c[EP_CYCLE_S] > 0.0:
        source, goal = goal, np.empty(size)
        polled(time_s, source, offsets, clock(c, time_s[0]), command[0], goal)
    if c[EP_BAND_MODE] in (1.0, 2.0):
        source, goal = goal, np.empty(goal.size)
        hold = bool(c[EP_BAND_MODE] == 1.0)
        start = held_at_first(float(source[0]), float(c[EP_BAND]), hold, float((p0 - c[EP_ZERO]) / c[EP_GAIN]))
        banded(source, c[EP_BAND], hold, start, goal)
    if c[EP_ZERO] != 0.0 or c[EP_GAIN] != 1.0 or c[EP_SUPPLY] < FOREVER or c[EP_DRIFTS] != 0.0:
        most = supply(c, time_s, offsets, goal.size, time_s[0])
        goal = supplied(zero(c, time_s, offsets, goal.size, time_s[0]) + c[EP_GAIN] * goal, most, c)
    if c[EP_SLEW] < FOREVER:
        source, goal = goal, np.empty(size)
        _slewed(time_s, source, offsets, c[EP_SLEW], p0, goal)
    if c[EP_RINGS_S] > 0.0:
        source, goal = goal, np.empty(size)
        ringing_pass(time_s, offsets, source, c, np.array([p0, 0.0]), goal)
    return goal


def clock(c: FloatArray, began_s: float) -> tuple[float, float]:
    """An instant at which a converter looks at its command, and the cycle in which it does [s]."""
    return float(began_s + c[EP_SEEN_S]), float(c[EP_CYCLE_S])


def dead_times_s(c: FloatArray) -> list[float]:
    """How long the commands take to arrive [s]: nothing for no dead time, two where rising and falling ones differ."""
    rising_s, longer_s = float(c[EP_DEAD_S]), float(c[EP_DEAD_FALLS])
    return [rising_s, rising_s + longer_s] if longer_s != 0.0 else [rising_s][: rising_s > 0.0]


def latest(c: FloatArray, goals: Sequence[FloatArray]) -> FloatArray:
    """What has arrived of commands that took each of `dead_times_s`: of two the one that goes where it takes longer."""
    if len(goals) == 1:
        return goals[0]
    return np.maximum(*goals) if c[EP_DEAD_FALLS] > 0.0 else np.minimum(*goals)


def through_ports(c: FloatArray) -> FloatArray:
    """The coefficients of a converter whose ports let less through, or are shut: of its booster and chamber, if any."""
    if c[EP_PORT_UP] == c[EP_PORT_DOWN] == 1.0 and c[EP_CHAMBER] == 0.0:
        return c
    ports = c[[EP_PORT_UP, EP_PORT_DOWN]]
    narrow = c.copy()
    if boosted(c):
        narrow[[EP_FULL_UP, EP_FULL_DOWN]] /= ports
        if c[EP_CHAMBER] > 0.0:
            narrow[EP_AIR] *= c[EP_CHAMBER]
            narrow[EP_CLIP] = min(c[EP_CLIP], c[EP_NOMINAL] if ports[0] > 1.0 else FOREVER)
    else:
        narrow[[EP_TAU_RISE_S, EP_TAU_FALL_S]] *= ports
    return narrow


def bounded(c: FloatArray) -> bool:
    """Whether the lag toward the goal is more than a lag: an overlap, a quick exhaust, a clogged passage, a limit."""
    limited = min(c[EP_RATE_UP], c[EP_RATE_DOWN], c[EP_CLIP], c[EP_CUT], c[EP_TANK]) < FOREVER
    return bool(limited or c[EP_BAND_MODE] >= 3.0 or acts(c, _OTHER_LAGS))


def boosted(c: FloatArray) -> bool:
    """Whether the pilot is followed by a booster of limited flow."""
    return bool(min(c[EP_FULL_UP], c[EP_FULL_DOWN]) < FOREVER)


@njit(cache=True, nogil=True, error_model="numpy")
def _mean_command(time_s: FloatArray, command: FloatArray, start_s: float, stop_s: float, j: int) -> tuple[float, int]:
    """Mean of the command steps over start..stop and the row it ended in; before the first row the first holds."""
    last = time_s.size - 1
    while j < last and time_s[j] <= start_s:
        j += 1
    if time_s[j] >= stop_s or j == last:
        return command[j], j
    total = 0.0
    at = start_s
    k = j
    while at < stop_s:
        end = stop_s if k == last else min(stop_s, time_s[k])
        if end > at:
            total += command[k] * (end - at)
            at = end
        if at < stop_s:
            k += 1
    return total / (stop_s - start_s), j


@njit(cache=True, nogil=True, error_model="numpy")
def _delayed(time_s: FloatArray, command: FloatArray, offsets: np.ndarray, dead_s: float, out: FloatArray) -> None:
    """Fills `out` (fine) with the mean over each fine step of the command `dead_s` earlier."""
    out[0] = command[0]
    j = 0
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        begin = time_s[i - 1] - dead_s
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            out[f], j = _mean_command(time_s, command, begin, begin + h, j)
            begin += h


@njit(cache=True, nogil=True, error_model="numpy")
def _slewed(
    time_s: FloatArray, goal: FloatArray, offsets: np.ndarray, slew: float, start: float, out: FloatArray
) -> float:
    """Fills `out` (fine) with a goal, per row or fine, that moves no faster than `slew`: its mean over each fine step.

    Returns where it stands at the end.
    """
    per_row, held = goal.size == time_s.size, start
    out[0] = held
    for i in range(1, time_s.size):
        step = slew * max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            before, wanted = held, goal[i] if per_row else goal[f]
            held = max(held - step, min(held + step, wanted))
            on_way = abs(held - before) / step  # share of the step that it moves
            out[f] = held - 0.5 * on_way * (held - before)
    return held


@njit(cache=True, nogil=True, error_model="numpy")
def _mixed(
    time_s: FloatArray, goal: FloatArray, offsets: np.ndarray, mixed_s: float, start: float, out: FloatArray
) -> float:
    """Fills `out` (fine) with a goal, per row or fine, behind a lag: its mean over each fine step; exact.

    Returns where it stands at the end.
    """
    per_row, held = goal.size == time_s.size, start
    out[0] = held
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        left = np.exp(-h / mixed_s)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            wanted = goal[i] if per_row else goal[f]
            out[f] = wanted + (held - wanted) * (1.0 - left) * mixed_s / h
            held = wanted + (held - wanted) * left
    return held
