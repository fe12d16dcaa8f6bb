"""The signals that a report draws, and how many of their points an eye can see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray

IntArray = npt.NDArray[np.int64]
#: Share of a line's whole range, within one row, from which a step is drawn whatever is left out beside it.
_FAST = 0.005


@dataclass(frozen=True, slots=True)
class Series:
    """What was measured and what the models say, row by row; float64 arrays of shape (n,), NaN = missing.

    Recordings follow each other: `record[i]` is the recording of row i, `time_s` starts anew with each. `before` is the
    design model as given, `retuned` the same with its own numbers refitted, `after` the updated model; all in the unit
    of position; `pressure_before` and `pressure_after` are what the first and the last of them make of the pressure.
    `heldout` marks rows that were held out in their turn, `false` rows recognised as false readings.
    """

    time_s: FloatArray
    command: FloatArray
    position: FloatArray
    before: FloatArray
    after: FloatArray
    heldout: npt.NDArray[np.bool_]
    travel: float
    retuned: FloatArray | None = None
    pressure: FloatArray | None = None
    pressure_before: FloatArray | None = None
    pressure_after: FloatArray | None = None
    false: npt.NDArray[np.bool_] | None = None
    record: IntArray | None = None
    names: tuple[str, ...] = ()
    pressure_unit: str = "psi"
    position_unit: str = "in"

    @property
    def run_time_s(self) -> FloatArray:
        """Time from 0 through all recordings in turn."""
        step = np.diff(self.time_s, prepend=self.time_s[:1])
        usual = float(np.median(step[step > 0])) if (step > 0).any() else 0.0
        return np.cumsum(np.where(self.starts, usual, step)) - (usual if self.time_s.size else 0.0)

    @property
    def starts(self) -> npt.NDArray[np.bool_]:
        """True in the first row of each recording."""
        if self.record is None:
            return np.asarray(np.arange(self.time_s.size) == 0, dtype=np.bool_)
        first = np.ones(min(1, self.time_s.size), dtype=np.bool_)
        return np.asarray(np.concatenate([first, np.diff(self.record) != 0]), dtype=np.bool_)

    def percent(self, values: FloatArray) -> FloatArray:
        """A position or a residual in percent of travel; false readings are NaN."""
        scaled = 100.0 / self.travel * values
        return scaled if self.false is None else np.where(self.false, np.nan, scaled)


def thin(values: FloatArray, points: int) -> IntArray:
    """Rows that keep the look of a line: first, last, lowest and highest of each of `points` / 4 stretches."""
    n = values.size
    if n <= points:
        return np.arange(n)
    width = int(np.ceil(4.0 * n / points))
    count = -(-n // width)
    padded = np.full(count * width, np.nan)
    padded[:n] = values
    blocks = padded.reshape(count, width)
    low = np.where(np.isnan(blocks), np.inf, blocks).argmin(axis=1)
    high = np.where(np.isnan(blocks), -np.inf, blocks).argmax(axis=1)
    first = np.arange(count) * width
    rows = np.concatenate([first, first + low, first + high, first + width - 1])
    return np.unique(np.clip(rows, 0, n - 1))


def thin_together(lines: Sequence[FloatArray], points: int) -> IntArray:
    """Rows that keep the look of lines that are drawn over each other: the extremes of each, and where one moves fast.

    On rows of its own each line would cut other corners, and lines that agree would seem to differ.
    """
    kept = [thin(values, points) for values in lines]
    for values in lines:
        known = values[np.isfinite(values)]
        step = np.abs(np.diff(values)) > _FAST * (np.ptp(known) if known.size else 0.0)
        fast = np.flatnonzero(np.append(step, False) | np.insert(step, 0, False))
        kept += [fast[:: -(-fast.size // points) or 1], np.flatnonzero(np.isnan(values))[:points]]
    return np.unique(np.concatenate(kept))


def busiest_window(series: Series, rows: int) -> slice:
    """The stretch of `rows` rows inside one recording, held out if possible, where the design model errs most."""
    excess = np.nan_to_num(np.square(series.percent(series.position - series.before)))
    return _busiest(series, excess - np.nan_to_num(np.square(series.percent(series.position - series.after))), rows)


def busiest_pressure(series: Series, rows: int) -> slice:
    """The same for the pressure, which has to be there."""
    assert series.pressure is not None and series.pressure_before is not None and series.pressure_after is not None
    excess = np.nan_to_num(np.square(series.pressure - series.pressure_before))
    return _busiest(series, excess - np.nan_to_num(np.square(series.pressure - series.pressure_after)), rows)


def _busiest(series: Series, excess: FloatArray, rows: int) -> slice:
    """The stretch of `rows` rows inside one recording with the most `excess`; what is held out counts more."""
    n = series.time_s.size
    rows = min(rows, n)
    total = np.concatenate([[0.0], np.cumsum(np.where(series.heldout, 1.0, 0.25) * excess)])
    gain = total[rows:] - total[:-rows]
    breaks = np.concatenate([[0], np.cumsum(series.starts)])
    crossing = (breaks[rows:] - breaks[1 : n - rows + 2]) > 0
    gain = np.where(crossing, -np.inf, gain)
    start = int(np.argmax(gain))
    return slice(start, start + rows)
