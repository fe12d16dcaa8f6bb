"""The converter's own clock, read off the rows in which a held reading is new.

A converter that refreshes every P seconds, polled every h < P, shows each new value in the first row after it: a row is
new when phase + n P lies between it and the row before. Every new row so puts two bounds on the phase, and a thousand
of them leave a sliver; what was read is then known to be as old as the time since the last of these instants, instead
of up to a row fresher. Source: Wittenmark, Nilsson, Torngren, Proc. American Control Conference (1995) 2000 (delays of
unsynchronised sampling).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

#: New rows that a clock takes, and how many of them the first look for its period goes by.
_LEAST, _FIRST = 40, 600
#: How far from the mean time between new rows the period is looked for; steps per turn over the record.
_RANGE, _PER_TURN = 0.35, 5.0
#: Refreshes per row above which they may be folded: then frequencies up to half that of the rows are looked at.
_FAST, _FOLD = 0.25, 0.51
#: Share of new rows that the clock has to explain, and of all rows in which it may refresh, or it explains nothing.
_EXPLAINED, _TELLING = 0.97, 0.85
#: Rows at whose bounds of the phase the rest may be false: a repeated value that was new, a clock that jitters.
_STRAY_PERCENT = 1.0


@dataclass(frozen=True, slots=True)
class Clock:
    """The converter refreshes at `latest_s` + n `period_s` (from the first row on), or up to `slack_s` earlier."""

    period_s: float
    latest_s: float
    slack_s: float

    def taken_s(self, t: FloatArray) -> FloatArray:
        """When what the rows at `t` read was taken, at the latest [s since the first row]."""
        middle = self.latest_s - 0.5 * self.slack_s
        return np.asarray(self.latest_s + self.period_s * np.floor((t - middle) / self.period_s))


def clock_of(time_s: FloatArray, reading: FloatArray) -> Clock | None:
    """The clock, None where the readings do not follow one that is slower than the rows."""
    t = time_s - time_s[0]
    new = np.flatnonzero(np.diff(reading) != 0.0) + 1
    if new.size < _LEAST or new.size > _TELLING * t.size:
        return None
    clocks = [_bounded(t, new, frequency) for frequency in _frequencies(t, new)]
    # the slowest that explains the new rows: a faster one refreshes in rows that are not new, too
    return max((c for c in clocks if _explains(c, t, new)), key=lambda c: c.period_s, default=None)


def _frequencies(t: FloatArray, new: npt.NDArray[np.intp]) -> list[float]:
    """Where the times of the new rows have a common rhythm [Hz]; folded ones, too, of a refresh almost as fast."""
    steps = np.diff(t)
    row_s = float(np.mean(steps[steps < 3.0 * np.median(steps)]))  # no median: it is off by what rows come unevenly
    early = new[:_FIRST]
    typical = (early.size - 1) / float(t[early[-1]] - t[early[0]])
    low, high = (1.0 - _RANGE) * typical, (1.0 + _RANGE) * typical
    if typical * row_s > _FAST:
        low, high = (1.0 - _RANGE) * min(typical, 1.0 / row_s - typical), _FOLD / row_s
    first = _strongest(t[early] - t[early[0]], low, high)
    found = []
    for one in (first, 1.0 / row_s - first):
        reach = 2.0 / max(float(t[early[-1]] - t[early[0]]), row_s)
        if 0.0 < one < 1.0 / row_s:
            found.append(_strongest(t[new], max(one - reach, 0.1 * one), one + reach))
    return found


def _strongest(times_s: FloatArray, low: float, high: float) -> float:
    """The frequency between `low` and `high` at which the times agree best on a phase."""
    count = max(3, int((high - low) * float(times_s[-1] - times_s[0]) * _PER_TURN) + 1)
    tried = np.linspace(low, high, count)
    power = [abs(np.exp(-2j * np.pi * f * times_s).mean()) for f in tried]
    return float(tried[int(np.argmax(power))])


def _bounded(t: FloatArray, new: npt.NDArray[np.intp], frequency: float) -> Clock:
    """Of the periods that this record cannot tell apart the one that leaves the phase most room, and that room."""
    best = Clock(float(1.0 / frequency), 0.0, -np.inf)
    for near in frequency + np.linspace(-1.0, 1.0, 81) * 0.25 / max(float(t[-1]), 1e-9):
        period = float(1.0 / near)
        turn = np.angle(np.exp(2j * np.pi * near * t[new]).mean()) / (2.0 * np.pi)
        count = np.round(t[new] * near - turn)
        latest = float(np.percentile(t[new] - count * period, _STRAY_PERCENT))
        earliest = float(np.percentile(t[new - 1] - count * period, 100.0 - _STRAY_PERCENT))
        if latest - earliest > best.slack_s:
            best = Clock(period, latest, latest - earliest)
    return best


def _explains(one: Clock, t: FloatArray, new: npt.NDArray[np.intp]) -> bool:
    """Whether it refreshes in the rows that are new, and not in nearly all."""
    if one.slack_s < 0.0:
        return False
    fresh = np.diff(one.taken_s(t), prepend=-np.inf) > 0.5 * one.period_s
    return bool(fresh[new].mean() > _EXPLAINED and fresh.mean() < _TELLING)
