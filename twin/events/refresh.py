"""The refresh period of a reading, to the accuracy that a replay needs, from the reading alone.

A held reading is late by a sawtooth of time: y = x - v d(t), with d growing from 0 to the period and falling back. So
the difference between the reading and its smooth, times the speed, has a sharp line at the refresh frequency, and the
phase of the line says when the reading was fresh. A period that is off by a ten thousandth loses step within minutes;
the line of a record of T seconds is 1/T wide, and its top is known better than that.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from logs.recording import FloatArray, Recording
from twin.events.clock import clock_of

#: Width of the smooth, in rows; refreshes much slower than this are smooth themselves.
_WIDTHS = (4.0, 16.0)
_LINES = 2
#: By how much more often the pressure repeats where the position does, of 1.
_TOGETHER = 0.5


@dataclass(frozen=True, slots=True)
class Refresh:
    """`period_s` between refreshes, and the first of them after the first row as a fraction of it."""

    period_s: float
    phase: float


@dataclass(frozen=True, slots=True, eq=False)
class Freshness:
    """Of each row's reading, shapes (n,): the row in which it was new, and when it was taken, at the latest.

    `taken_s`: since the first row, by the converter's own clock where it has one; up to `slack_s` earlier is possible.
    `before_s`: when the reading before it was.
    """

    rows: npt.NDArray[np.intp]
    taken_s: FloatArray
    before_s: FloatArray
    slack_s: float

    def kept(self, rows: npt.NDArray[np.intp], time_s: FloatArray) -> Freshness:
        """The same for some rows of the recording (increasing); `time_s`: of all its rows."""
        new = np.maximum(self.rows[rows], rows[0])
        at = np.asarray(np.searchsorted(rows, new, side="right") - 1)
        cut_s = float(time_s[rows[0]] - time_s[0])
        return Freshness(at, self.taken_s[rows] - cut_s, self.before_s[rows] - cut_s, self.slack_s)


def freshness(recording: Recording) -> Freshness:
    """How fresh each row's reading is, as far as the readings tell."""
    rows, t = fresh_rows(recording.position), recording.time_s - recording.time_s[0]
    clock = clock_of(recording.time_s, recording.position)
    if clock is not None:
        return Freshness(rows, clock.taken_s(t), _before(clock.taken_s(t)), clock.slack_s)
    return Freshness(rows, t[rows], _before(t[rows]), float(np.median(np.diff(t))))  # new since the row before


def _before(taken_s: FloatArray) -> FloatArray:
    """When the reading before each row's was taken; the first of all has none before it."""
    new = np.diff(taken_s, prepend=-np.inf) > 0.0
    return np.asarray(taken_s[new][np.maximum(np.cumsum(new) - 2, 0)])


def refreshes(time_s: FloatArray, reading: FloatArray) -> list[Refresh]:
    """Periods that the reading's lateness suggests, the strongest lines first; empty for a record too short."""
    known = np.isfinite(reading)
    if np.count_nonzero(known) < 64:
        return []
    t = time_s - time_s[0]
    y = np.interp(t, t[known], reading[known])
    row_s = float(np.median(np.diff(t)))
    found: list[Refresh] = []
    seen: list[float] = []
    for width in _WIDTHS:
        for frequency in _lines(_lateness(t, y, width), row_s):
            if any(abs(frequency - other) * t[-1] < 3.0 for other in seen):
                continue
            seen.append(frequency)
            for true in (frequency, 1.0 / row_s - frequency):  # a refresh faster than every other row is folded
                if true * row_s < 0.97:
                    found.append(_refined(t, y, width, true))
    return found


def fresh_rows(reading: FloatArray) -> npt.NDArray[np.intp]:
    """The row in which each row's reading was new: its own, or the earlier one since which it is the same; (n,)."""
    new = np.diff(reading, prepend=np.nan) != 0.0
    return np.asarray(np.maximum.accumulate(np.where(new, np.arange(reading.size), 0)))


def refreshed_together(recording: Recording) -> bool:
    """Whether the pressure is held in the rows in which the position is, and not in the others: one slow converter.

    What drives the model is then as late as what it is compared with.
    """
    if recording.pressure is None:
        return False
    held = np.diff(recording.position) == 0.0
    same = np.diff(recording.pressure) == 0.0
    if not held.any() or held.all():
        return False
    return bool(np.mean(same[held]) - np.mean(same[~held]) > _TOGETHER)


def new_only(recording: Recording) -> Recording:
    """The recording without the readings that repeat both the position and the pressure of the row before.

    They say nothing that was not said, and were true at another time.
    """
    assert recording.pressure is not None
    repeated = (np.diff(recording.position) == 0.0) & (np.diff(recording.pressure) == 0.0)
    old = np.concatenate([[False], repeated])
    position, pressure = (np.where(old, np.nan, values) for values in (recording.position, recording.pressure))
    return replace(recording, position=position, pressure=pressure)


def _lateness(t: FloatArray, y: FloatArray, width: float) -> FloatArray:
    """What the reading is off its smooth, times its speed: speed squared times the sawtooth of the lateness."""
    smooth = gaussian_filter1d(y, width, mode="nearest")
    speed = np.gradient(smooth, t)
    product = (y - smooth) * speed
    bound = 8.0 * float(np.mean(np.abs(product))) + 1e-300
    return np.asarray(np.clip(product, -bound, bound))


def _lines(product: FloatArray, row_s: float) -> list[float]:
    """Frequencies [Hz] of the strongest lines."""
    size = 4 * product.size
    power = np.abs(np.fft.rfft(product - product.mean(), size))
    frequency = np.fft.rfftfreq(size, row_s)
    power[frequency < 0.03 / row_s] = 0.0
    tops = []
    for _ in range(_LINES):
        top = int(np.argmax(power))
        tops.append(float(frequency[top]))
        power[max(0, top - 12) : top + 13] = 0.0
    return tops


def _refined(t: FloatArray, y: FloatArray, width: float, frequency: float) -> Refresh:
    """The top of the line, with the true times of the rows, and its phase."""
    product = _lateness(t, y, width)
    product = product - product.mean()
    near = frequency + np.linspace(-1.0, 1.0, 41) / max(float(t[-1]), 1e-9)
    line = np.exp(-2j * np.pi * near[:, None] * t[None, :]) @ product
    top = int(np.argmax(np.abs(line)))
    turn = -(np.angle(line[top]) + 0.5 * np.pi) / (2.0 * np.pi)
    return Refresh(float(1.0 / near[top]), float(turn % 1.0))
