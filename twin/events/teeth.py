"""Teeth: a stem that is pushed one way stands, and then jumps to where it should have been, time after time.

Whatever lag comes behind the friction is undone: y + tau dy/dt is where the stem is going. Along one way of the
pressure that is a straight or gently curved line for anything that slides. What sticks falls behind the line and jumps
back to it: a tooth, as long as the pressure that it took. When each slip comes may be beyond any model; how many teeth
there are, and how long they are, is not.
Source: Choudhury, Thornhill & Shah, Control Engineering Practice 13 (2005) 641 (stickband, slip jump); Wood, Nature 466
(2010) 1102 (summary statistics where a path cannot be followed).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numba import njit
from scipy.ndimage import gaussian_filter1d

from logs.recording import FloatArray
from twin.where.regime import speed_sigma

_BELL_S = 0.4
#: Standard deviations of where the stem is going that a tooth is longer than.
_CLEAR = 6.0
#: Of the pressure's noise, by which it turns when it goes another way; and of the deadband.
_TURNS, _OF_DEADBAND = 8.0, 0.04
#: Rows that a way has at the least.
_SHORTEST = 10
#: Teeth of each way without which nothing is said of their places; shifts of the ones against the others, and the share
#: of what they are apart then from which on they lie together.
_LEAST, _SHIFTS, _TOGETHER = 5, 97, 0.4


@dataclass(frozen=True, slots=True)
class Valve:
    """What undoes a valve's lag: its compliance and time constant; its deadband [pressure]; the noise of its readings
    (`sigma`, white but for `memory` readings) and of the pressure."""

    compliance: float
    tau_s: float
    deadband: float
    sigma: float
    sigma_p: float
    memory: float = 1.0


@dataclass(frozen=True, slots=True)
class Teeth:
    """How long each is [pressure], where the stem stood, and which way it was pushed (+1 closing); shape (n,)."""

    length: FloatArray
    place: FloatArray
    way: FloatArray

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.length.size)

    @property
    def typical(self) -> float:
        """Median length [pressure]; 0 where there is none."""
        return float(np.median(self.length)) if self.count else 0.0

    @property
    def total(self) -> float:
        """Length [pressure] of all of them together: what a rough model makes may be many, and short."""
        return float(self.length.sum())


@dataclass(frozen=True, slots=True)
class Slips:
    """By which teeth a slipping stem was recognised: those of the readings, and those of the model that makes them."""

    seen: Teeth
    model: Teeth


@dataclass(frozen=True, slots=True, eq=False)
class Pushes:
    """How a valve was pushed at the times `time_s`: its smoothed pressure, and the rows at which that turns.

    `bell`: by which readings are smoothed, rows; `clear`: how far a tooth leaves the line at the least [position].
    """

    time_s: FloatArray
    psi: FloatArray
    turned: list[int]
    bell: float
    clear: float
    valve: Valve


def pushes(time_s: FloatArray, pressure: FloatArray, valve: Valve) -> Pushes:
    """Those of a recording without gaps; both of shape (n,)."""
    period_s = float(np.median(np.diff(time_s)))
    bell = max(_BELL_S / period_s, 1.0)
    psi = gaussian_filter1d(pressure, bell, mode="nearest")
    turned = turns(psi, max(_TURNS * valve.sigma_p, _OF_DEADBAND * valve.deadband))
    clear = _CLEAR * valve.tau_s * speed_sigma(valve.sigma, period_s, bell, valve.memory)
    return Pushes(time_s, psi, turned, bell, clear, valve)


def teeth(pushed_by: Pushes, reading: FloatArray) -> Teeth:
    """The teeth of a reading, shape (n,), of a valve that was pushed so."""
    time_s, psi, clear, valve = pushed_by.time_s, pushed_by.psi, pushed_by.clear, pushed_by.valve
    smooth = gaussian_filter1d(reading, pushed_by.bell, mode="nearest")
    going = smooth + valve.tau_s * np.gradient(smooth, time_s)
    found: list[tuple[float, float, float]] = []
    for start, stop in pairwise(pushed_by.turned):
        way = 1.0 if psi[stop] > psi[start] else -1.0
        pushed = np.flatnonzero(way * (going[start : stop + 1] - going[start]) > clear)
        if not pushed.size or stop - start - pushed[0] < _SHORTEST:
            continue
        rows = slice(start + int(pushed[0]), stop + 1)
        behind = way * (valve.compliance * psi[rows] - going[rows])
        last = 0
        for at, to in pairwise(turns(behind, clear)):
            if at > 0 and behind[at] > behind[to]:
                length = float(behind[at] - behind[to]) / valve.compliance
                found.append((length, float(going[rows][(last + at) // 2]), way))
            last = at
    return Teeth(*np.array(found, dtype=np.float64).reshape(-1, 3).T)


def together(some: Sequence[Teeth]) -> Teeth:
    """Those of several recordings."""
    return Teeth(*(np.concatenate([getattr(t, name) for t in some]) for name in ("length", "place", "way")))


def fixed_in_place(found: Teeth) -> bool:
    """Whether the stem stands at the same places whichever way it goes: something in the way holds it, and no friction.

    Held against the same places shifted, round the stroke, by anything.
    """
    closing, opening = found.place[found.way > 0], found.place[found.way < 0]
    if min(closing.size, opening.size) < _LEAST:
        return False
    low, span = float(found.place.min()), float(np.ptp(found.place))
    shifts = np.linspace(0.0, span, _SHIFTS, endpoint=False)
    apart = [_apart(closing, low + (opening - low + by) % span) for by in shifts]
    return apart[0] < _TOGETHER * float(np.median(apart))


def _apart(ones: FloatArray, others: FloatArray) -> float:
    """How far the ones are from the next of the others, in the median."""
    return float(np.median(np.abs(ones[:, None] - others).min(axis=1)))


@njit(cache=True, nogil=True, error_model="numpy")
def turns(values: FloatArray, least: float) -> list[int]:
    """Rows at which values turn by more than `least`, from the first extreme to the last; none where they never do."""
    found = [0 for _ in range(0)]
    low = high = way = 0
    for row in range(values.size):
        if way <= 0 and values[row] < values[low]:
            low = row
        if way >= 0 and values[row] > values[high]:
            high = row
        if way <= 0 and values[row] - values[low] > least:
            found.append(low)
            way, high = 1, row
        elif way >= 0 and values[high] - values[row] > least:
            found.append(high)
            way, low = -1, row
    if way:
        found.append(high if way > 0 else low)
    return found
