"""The two steady-state backlash curves from the dwells of a record: pressure where the valve closes, where it opens.

A dwell that the stem reached by moving up lies on the closing curve, one reached by moving down on the opening curve;
one that left the stem where it was lies in the deadband, and those at the stops are on no curve.
Source: Lustrino, MIT 2009, sections 1.4 and 2.1, figures 1-6 and 2-4.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from control.identify_interval import Interval
from control.identify_readings import fast_noise
from control.robust_line import robust_line
from logs.recording import FloatArray, Recording

LEAST_DWELL_S = 2.0
TAIL_SHARE = 0.3  # the last part of a dwell that is averaged
STOP_SHARE = 0.02  # of the range of positions: closer to an end than this is at a stop
FEWEST_POINTS = 4
VAGUE_ONSET = 0.05  # of the range of pressures
NONE_SETTLED = "no curves through settled dwells to compare with: the stem still moves in all; a staircase stays longer"
SETTLED_TAUS = 2.5  # a tail that begins later than so many time constants is corrected for what is left to move


@dataclass(frozen=True, slots=True)
class Dwells:
    """Steady readings, one per stay of the command; arrays of shape (m,). `drift` is the change over the tail.

    `moved` is the stem's change since the dwell before, NaN for the first and across a gap.
    """

    start_s: FloatArray  # when the command took effect: the row before the first that shows it
    tail_s: FloatArray  # begin and end of the averaged tail, counted from the start of the dwell, shape (m, 2)
    command: FloatArray
    pressure: FloatArray
    position: FloatArray
    moved: FloatArray
    drift: FloatArray


@dataclass(frozen=True, slots=True)
class Curve:
    """position = compliance * (pressure - onset) on one branch, with the points it was drawn through."""

    onset: Interval
    compliance: Interval
    pressure: FloatArray
    position: FloatArray
    used: np.ndarray


@dataclass(frozen=True, slots=True)
class BacklashCurves:
    """Closing: a1 and k1. Opening: a2 and k2. A branch without enough points is None, and `notes` says so."""

    closing: Curve | None
    opening: Curve | None
    notes: tuple[str, ...] = ()


def find_dwells(recording: Recording, longest_s: float = np.inf) -> Dwells:
    """The stays of at least 2 s during which the command did not change; pressure is the command where not measured.

    Of a stay longer than `longest_s` only that much is looked at.
    """
    command, time_s = recording.command, recording.time_s
    broken = np.zeros(recording.n, dtype=bool) if recording.gap_before is None else recording.gap_before.copy()
    tolerance = 1e-6 * (float(np.ptp(command)) + 1e-12)
    changes = np.flatnonzero((np.abs(np.diff(command)) > tolerance) | broken[1:]) + 1
    edges = np.concatenate(([0], changes, [recording.n]))
    pressure = command if recording.pressure is None else recording.pressure
    rows: list[tuple[float, ...]] = []
    last, unbroken = np.nan, True
    for start, end in pairwise(edges):
        unbroken = unbroken and not broken[start]
        if time_s[end - 1] - time_s[start] < LEAST_DWELL_S:
            continue
        stop = int(np.searchsorted(time_s[:end], time_s[start] + longest_s, side="right"))
        begin = int(np.searchsorted(time_s[:stop], time_s[stop - 1] - TAIL_SHARE * (time_s[stop - 1] - time_s[start])))
        x, p = recording.position[begin:stop], pressure[begin:stop]
        if np.isfinite(x).sum() < 2 or np.isfinite(p).sum() < 2:
            continue
        half = begin + (stop - begin) // 2
        position = float(np.nanmedian(x))
        drift = float(np.nanmean(recording.position[half:stop]) - np.nanmean(recording.position[begin : half or 1]))
        moved = position - last if unbroken else np.nan
        began_s = time_s[max(0, start - 1)]
        tail_s = (time_s[begin] - began_s, time_s[stop - 1] - began_s)
        rows.append((began_s, *tail_s, command[start], float(np.nanmean(p)), position, moved, drift))
        last, unbroken = position, True
    table = np.array(rows).reshape(-1, 8)
    return Dwells(table[:, 0], table[:, 1:3], *table[:, 3:].T)


@dataclass(frozen=True, slots=True)
class Settling:
    """What is known of how the stem comes to rest: its lag, the converter's before it, its top speed."""

    tau_s: float
    delay_s: float
    rate_limit: float

    def waits_s(self, moved: FloatArray) -> FloatArray:
        """How long the exponential end of a motion is put off: by the converter, and by the rate limit."""
        limited_s = np.abs(moved) / self.rate_limit - self.tau_s
        return np.asarray(self.delay_s + np.maximum(np.nan_to_num(limited_s), 0.0))


def at_rest(dwells: Dwells, settling: Settling) -> FloatArray:
    """Where the stem would have come to rest, shape (m,), when its lag was still at work in the tails."""
    tau_s = settling.tau_s
    begin, end = np.maximum(dwells.tail_s - settling.waits_s(dwells.moved)[:, None], 0.0).T
    left = np.exp(-0.5 * (begin + end) / tau_s)  # `position` is a median, and the stem is there half-way through
    moved = np.where(np.isfinite(dwells.moved), dwells.moved, 0.0)
    return np.asarray(dwells.position + moved * left / (1.0 - np.minimum(left, 0.9)))


def characterize(recordings: list[Recording], settling: Settling | None = None) -> BacklashCurves:
    """The curves through the dwells of all recordings (same units).

    A dwell counts when the stem moved towards it by more than the noise and had come to rest. With `settling`
    known, the little that was left to move is added.
    """
    found = [find_dwells(recording) for recording in recordings]
    pressure = np.concatenate([d.pressure for d in found])
    position = np.concatenate([at_rest(d, settling) if settling else d.position for d in found])
    moved = np.concatenate([d.moved for d in found])
    drift = np.concatenate([d.drift for d in found])
    if position.size < FEWEST_POINTS:
        return BacklashCurves(None, None, ("no dwells: the curves need a staircase or other stays of 2 s and more",))
    low = min(float(np.nanmin(r.position)) for r in recordings)
    reach = max(float(np.nanmax(r.position)) for r in recordings) - low
    noise = max(fast_noise(r.position) for r in recordings)
    inside = (position > low + STOP_SHARE * reach + 3 * noise) & (position < low + (1 - STOP_SHARE) * reach - 3 * noise)
    least = max(4.0 * noise, 0.004 * reach)
    settled = np.abs(drift) < np.maximum(3.0 * noise, 0.1 * np.abs(moved))
    if settling is not None:
        free_s = np.concatenate([d.tail_s[:, 0] - settling.waits_s(d.moved) for d in found])
        settled &= free_s > SETTLED_TAUS * settling.tau_s
    notes = []
    curves: list[Curve | None] = []
    if not (inside & settled & (np.abs(moved) > least)).any():
        return BacklashCurves(None, None, (NONE_SETTLED,))
    for name, mask in (("closing", moved > least), ("opening", moved < -least)):
        chosen = mask & inside & settled
        curve = fit_curve(pressure[chosen], position[chosen]) if chosen.sum() >= FEWEST_POINTS else None
        if curve is None:
            notes.append(f"{name} curve: {int(chosen.sum())} settled dwells on it, at least {FEWEST_POINTS} are needed")
        elif curve.onset.half_width > VAGUE_ONSET * np.ptp(pressure):
            notes.append(f"{name} curve: its {int(chosen.sum())} settled dwells do not lie on one line")
            curve = None
        curves.append(curve)
    return BacklashCurves(curves[0], curves[1], tuple(notes))


def fit_curve(pressure: FloatArray, position: FloatArray) -> Curve | None:
    """A straight line through the points of a branch that outliers cannot pull; None when they lie at one pressure.

    Intervals from the scatter, with Student's t; that of the onset, a ratio, by the delta method.
    """
    from scipy.stats import t as student

    if np.ptp(pressure) < 1e-9:
        return None
    line = robust_line(pressure, position)
    if line.slope <= 0.0:
        return None
    onset = -line.start / line.slope
    gradient = np.array([-1.0 / line.slope, line.start / line.slope**2])
    reach = float(student.ppf(0.975, line.freedom))
    onset_reach = reach * float(np.sqrt(gradient @ line.spread @ gradient))
    slope_reach = reach * float(np.sqrt(line.spread[1, 1]))
    return Curve(
        Interval(onset, onset - onset_reach, onset + onset_reach),
        Interval(line.slope, line.slope - slope_reach, line.slope + slope_reach),
        pressure,
        position,
        line.used,
    )
