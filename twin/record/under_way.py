"""Whether a valve was under way when its recording began: not all that moves it then can be read in the first row.

What pushes the stem may lag behind the pressure, and where it would have gone is where the pressure had been. A valve
at rest is known: while its command stands still, neither pressure nor stem moves.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from control.design import DesignModel
from logs.recording import FloatArray, Recording

#: How long the first rows are looked at: so many lags of the converter, seconds and rows at the least.
_LAGS, _LOOK_S, _ROWS = 5.0, 1.5, 5
#: Share of the command's span that is a step.
_STEP = 0.02
#: What moves by a larger share of the deadband or of travel than this, and by more deviations of its noise.
_PRESSURE, _STEM, _SURE = 0.05, 0.003, 6.0


def under_way(design: DesignModel, recording: Recording) -> bool:
    """Whether pressure or stem move in the first rows, in which the command stands still."""
    rows = _first_rows(design, recording)
    if np.count_nonzero(rows) < _ROWS:
        return False
    pressure = recording.pressure
    moves = pressure is not None and _moves(pressure, rows, _PRESSURE * design.travel / design.compliance)
    return moves or _moves(recording.position, rows, _STEM * design.travel)


def _first_rows(design: DesignModel, recording: Recording) -> npt.NDArray[np.bool_]:
    """The first rows, as long as the command stands still."""
    since_s = recording.time_s - recording.time_s[0]
    look_s = max(_LAGS * design.ep_tau_s, _LOOK_S, since_s[min(_ROWS, recording.n) - 1])
    steps = np.abs(recording.command - recording.command[0]) > _STEP * np.ptp(recording.command)
    return np.asarray((since_s <= look_s) & ~np.logical_or.accumulate(steps))


def _moves(signal: FloatArray, rows: npt.NDArray[np.bool_], least: float) -> bool:
    """Whether a signal ends the rows elsewhere than it begins them; medians of three, for false ones."""
    values = signal[rows & np.isfinite(signal)]
    if values.size < _ROWS:
        return False
    noise = 1.4826 * float(np.median(np.abs(np.diff(signal[np.isfinite(signal)], 2)))) / np.sqrt(6.0)
    moved = abs(float(np.median(values[-3:]) - np.median(values[:3])))
    return bool(moved > max(least, _SURE * noise))
