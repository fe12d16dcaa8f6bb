"""A run in figures: range, mean and spread of each column, and how well the bench kept its time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray
from logs.run import Run


@dataclass(frozen=True, slots=True)
class ColumnStatistics:
    """`missing` samples are NaN; the figures are those of the others, NaN when there is none."""

    name: str
    unit: str
    low: float
    mean: float
    high: float
    spread: float
    missing: int


@dataclass(frozen=True, slots=True)
class Timing:
    """Median period [s], and median, 99th percentile and worst of a delay [s]; None where it was not recorded."""

    period_s: float
    lateness_s: tuple[float, float, float] | None
    latency_s: tuple[float, float, float] | None


def column_statistics(run: Run) -> list[ColumnStatistics]:
    return [_of(name, run.units.get(name, ""), values) for name, values in run.columns.items() if name != "time_s"]


def timing(run: Run) -> Timing:
    time_s = run.columns.get("time_s", np.zeros(0))
    period_s = float(np.nanmedian(np.diff(time_s))) if time_s.size > 1 else float("nan")
    return Timing(period_s, _delay(run.columns.get("lateness_s")), _delay(run.columns.get("latency_s")))


def _of(name: str, unit: str, values: FloatArray) -> ColumnStatistics:
    good = values[np.isfinite(values)]
    missing = values.size - good.size
    if not good.size:
        nan = float("nan")
        return ColumnStatistics(name, unit, nan, nan, nan, nan, missing)
    return ColumnStatistics(
        name, unit, float(good.min()), float(good.mean()), float(good.max()), float(good.std()), missing
    )


def _delay(values: FloatArray | None) -> tuple[float, float, float] | None:
    if values is None or not np.isfinite(values).any():
        return None
    good = values[np.isfinite(values)]
    return float(np.median(good)), float(np.percentile(good, 99)), float(good.max())
