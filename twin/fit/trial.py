"""A recording made ready for fitting: time grid, start state, which rows count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from logs.recording import FloatArray, Recording
from twin.events.refresh import Freshness
from twin.model.place import ALONE, Place
from twin.model.timegrid import TimeGrid, make_grid
from twin.record.begun import Begun

#: Rows right after the start that do not count: the state before the first row is unknown.
SETTLE_S = 3.0
#: Share of the command's span that is a step; in times of the short intervals, one in which rows are missing; the
#: largest share of rows that steps at unknown times may cost.
_STEP, _LATE, _MOST = 0.02, 1.6, 0.5
#: By how much times between rows are off whole periods, and the share of them of a clock that does not tremble; the
#: longest times of one that trembles by a quarter, in the middle ones.
_WHOLE, _REGULAR, _LONG = 0.15, 0.7, 1.9
#: So many readings on one side of the first four are neither of these nor a few outliers.
_BACK = 5
#: Standard deviation of the bell that takes the noise off the readings, for how fast they move.
_SMOOTH_S = 0.15


@dataclass(frozen=True, slots=True)
class Trial:
    """One recording with its fine grid. `use_p`, `use_y` (bool, shape (n,)) mark the rows that count.

    Of those that do not, `false` are false readings of the position, and `vague` rows behind a step of the command at a
    time that nobody knows.

    `begun`: what else is known of the state before the first row.
    `pressure` on the fine grid is the smoothed measured pressure, once it is known (see `twin/fit/smooth.py`).
    `fresh`: how fresh each row's reading is, where readings are seen to be held.
    `place`: among the recordings of the case.
    `led_s`: so long it only leads to where it is looked at.
    `stem` on the fine grid is where the readings have it, for converters that it takes air from; None without pressure.
    """

    recording: Recording
    grid: TimeGrid
    start_pressure: float
    start_position: float
    begun: Begun
    use_p: npt.NDArray[np.bool_]
    use_y: npt.NDArray[np.bool_]
    false: npt.NDArray[np.bool_]
    vague: npt.NDArray[np.bool_]
    pressure: FloatArray | None = None
    fresh: Freshness | None = None
    place: Place = ALONE
    stem: FloatArray | None = None
    led_s: float = 0.0

    def with_pressure(self, pressure: FloatArray) -> Trial:
        """The same trial with a smoothed measured pressure on its fine grid."""
        return replace(self, pressure=pressure)


def make_trial(
    recording: Recording,
    step_s: float | FloatArray,
    bad_rows: npt.NDArray[np.bool_] | None = None,
    begun: Begun | None = None,
    fresh: Freshness | None = None,
    vague: npt.NDArray[np.bool_] | None = None,
) -> Trial:
    """Prepares a recording; `bad_rows` are false readings of the position that no fit may see.

    `begun`: the state before the first row, None: as the first row has it, and at rest. `vague`: see `Trial`; found in
    the recording itself, unless its rows are some of another's.
    """
    begun = begun or Begun()
    grid = make_grid(recording.time_s, step_s, recording.command)
    known = np.isfinite(recording.position)
    false = np.zeros_like(known) if bad_rows is None else known & bad_rows
    vague = after_unseen_steps(recording) if vague is None else vague
    use_y = known & ~false
    early = recording.time_s - recording.time_s[0] < SETTLE_S
    use_p = np.zeros_like(use_y)
    if recording.pressure is not None:
        use_p = np.isfinite(recording.pressure) & ~early & ~vague
    else:
        use_y &= ~vague
    steady = _steady_rows(recording.command)
    position = _at_start(recording.position, use_y, steady)
    pressure = recording.command[0] if begun.pressure is None else begun.pressure
    if recording.pressure is not None and np.isfinite(recording.pressure[:50]).any():
        pressure = _at_start(recording.pressure, np.isfinite(recording.pressure), steady)
    stem = None if recording.pressure is None else _stem_as_read(recording, grid, use_y)
    use_y &= recording.time_s - recording.time_s[0] >= max(SETTLE_S, begun.unsure_s)
    return Trial(recording, grid, float(pressure), position, begun, use_p, use_y, false, vague, fresh=fresh, stem=stem)


def _stem_as_read(recording: Recording, grid: TimeGrid, use: npt.NDArray[np.bool_]) -> FloatArray | None:
    """The readings on the fine grid with most of their noise off: what counts is how fast the stem moves."""
    rows = np.flatnonzero(use)
    if rows.size < 2:
        return None
    read = np.interp(np.arange(recording.n), rows, recording.position[rows])
    smooth = gaussian_filter1d(read, max(_SMOOTH_S / recording.period_s, 1.0), mode="nearest")
    fine: FloatArray = np.interp(np.arange(grid.n_fine), grid.offsets, smooth)
    return fine


def after_unseen_steps(recording: Recording) -> npt.NDArray[np.bool_]:
    """Rows that still feel a step of the command whose time nobody knows, because it fell among missing rows.

    None of them where that would leave too little: then the step is taken for where the row says.
    """
    none = np.zeros(recording.n, dtype=np.bool_)
    if recording.n < 3:
        return none
    since_s = np.diff(recording.time_s, prepend=recording.time_s[0])
    step = np.abs(np.diff(recording.command, prepend=recording.command[0]))
    late = since_s > _longest_s(since_s[1:])
    unseen = late & (step > _STEP * np.ptp(recording.command))
    last_s = np.maximum.accumulate(np.where(unseen, recording.time_s, -np.inf))
    vague = recording.time_s - last_s < SETTLE_S
    return np.asarray(vague) if vague.mean() < _MOST else none


def _longest_s(between_s: FloatArray) -> float:
    """Time between rows beyond which some are missing: by the short ones where all are whole periods, however many are
    missing; of a clock that trembles those are no measure."""
    short_s = float(np.percentile(between_s, 10.0))
    off = np.abs(between_s / short_s - np.round(between_s / short_s))
    trembles = np.mean(off < _WHOLE) < _REGULAR
    return _LONG * float(np.median(between_s)) if trembles else _LATE * short_s


def _steady_rows(command: FloatArray) -> int:
    """How many rows the command stays at its first value."""
    changed = np.flatnonzero(command != command[0])
    return int(changed[0]) if changed.size else command.size


def _at_start(signal: FloatArray, use: npt.NDArray[np.bool_], steady: int) -> float:
    """The first value: the mean over the readings before the signal leaves the band of its own noise.

    One noisy reading of the pressure would move the play off for as long as the stem then takes to settle; a first one
    that is alone outside of the band is none of them. A signal that comes back, in the `steady` rows before the command
    changes, swings about where it is: the mean over those.
    """
    values = signal[use][:200]
    if values.size < 4:
        return float(values[0]) if values.size else 0.0
    # second differences: the first ones of a stem that moves at once are motion
    noise = 1.4826 * float(np.median(np.abs(np.diff(values, 2)))) / np.sqrt(6.0)
    base = float(np.median(values[:4]))
    outside = np.abs(values - base) > 4.0 * noise + 1e-12
    if outside[0] and not outside[1 : 1 + _BACK].any():
        values, outside = values[1:], outside[1:]
    away = np.flatnonzero(outside)
    still = values[: max(int(away[0]), 1)] if away.size else values
    waiting = signal[:steady][use[:steady]]
    if away.size and _swings(waiting, base, 4.0 * noise):
        still = waiting
    return float(np.mean(still))


def _swings(values: FloatArray, base: float, band: float) -> bool:
    """Whether `values` are beyond the band about `base` on both sides: what settles goes one way."""
    above, below = np.count_nonzero(values > base + band), np.count_nonzero(values < base - band)
    return min(int(above), int(below)) >= _BACK


def concatenate(parts: Sequence[FloatArray]) -> FloatArray:
    """One array out of the trials' arrays, in their order."""
    return np.concatenate(parts) if len(parts) > 1 else np.asarray(parts[0])
