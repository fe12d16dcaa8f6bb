"""The travel as the stops show it: readings while the pressure drives far beyond them.

A least-squares travel bends with every misfit of the model; a stem that is pressed against its stop does not.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from control.design import DesignModel
from logs.recording import FloatArray, Recording

#: Share of travel by which the design has to be driven beyond a stop, and for how many of its slowest lags.
_BEYOND, _LAGS = 0.1, 5.0
#: Rows that make a plateau, their share of all that are driven there, and how far they may lie apart [of travel]: a
#: stem may stick short of the stop for a while, never beyond it.
_FEWEST, _SHARE, _WIDTH = 20, 0.1, 0.01


def travel_between_stops(recordings: Sequence[Recording], design: DesignModel) -> float | None:
    """From the closed plateau to the open one [position unit of the records]; None where either is not in them.

    `design` says which rows are at a stop, and need be right only roughly. Without a measured pressure the command,
    late by the converter's lag, stands for it.
    """
    ends: tuple[list[FloatArray], list[FloatArray]] = ([], [])
    for recording in recordings:
        driver = recording.command if recording.pressure is None else recording.pressure
        known = np.isfinite(driver) & np.isfinite(recording.position)
        beyond = _BEYOND * design.travel
        top = design.compliance * (driver - design.a1) > design.travel + beyond
        bottom = design.compliance * (driver - design.a2) < -beyond
        wait_s = design.travel / design.rate_limit + _LAGS * (design.tau_s + design.ep_tau_s)
        for k, there in enumerate((bottom, top)):
            ends[k].append(recording.position[_for_long(recording.time_s, there & known, wait_s)])
    low, high = (
        _plateau(np.concatenate(parts), side, design.travel) for parts, side in zip(ends, (5.0, 95.0), strict=True)
    )
    return None if low is None or high is None else high - low


def _for_long(time_s: FloatArray, there: npt.NDArray[np.bool_], wait_s: float) -> npt.NDArray[np.bool_]:
    """Rows that have been `there` without a break for `wait_s`."""
    last_away_s = np.maximum.accumulate(np.where(there, -np.inf, time_s))
    return np.asarray(there & (time_s - np.maximum(last_away_s, time_s[0]) >= wait_s), dtype=np.bool_)


def _plateau(readings: FloatArray, percentile: float, travel: float) -> float | None:
    """The level of the outermost readings, if enough of them agree."""
    if readings.size < _FEWEST:
        return None
    near = readings[np.abs(readings - np.percentile(readings, percentile)) < 0.5 * _WIDTH * travel]
    return float(np.median(near)) if near.size >= max(_FEWEST, _SHARE * readings.size) else None
