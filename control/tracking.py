"""How well a closed-loop run has held its targets, from its record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from logs.recording import FloatArray
from logs.run import Run

SETTLED_SHARE = 0.02  # of travel


@dataclass(frozen=True, slots=True)
class TargetResult:
    """One target: the mean and the swing (5 to 95 percentile) over the last quarter of its hold, and when it was
    reached to within 2 % of travel for good (None: not by the end)."""

    target_in: float
    final_in: float
    final_error_in: float
    swing_in: float
    settled_s: float | None


def judge_targets(run: Run, travel_in: float) -> list[TargetResult]:
    """One result per target of the run; a target without a single reading is left out."""
    columns = run.columns
    results = []
    for step in np.unique(columns["step"][columns["step"] >= 0]):
        rows = (columns["step"] == step) & np.isfinite(columns["position_in"]) & np.isfinite(columns["target_in"])
        if rows.any():
            results.append(
                judge(
                    columns["time_s"][rows],
                    columns["position_in"][rows],
                    float(columns["target_in"][rows][-1]),
                    travel_in,
                )
            )
    return results


def judge(time_s: FloatArray, position_in: FloatArray, target_in: float, travel_in: float) -> TargetResult:
    """The result for one hold; arrays of shape (n,), n >= 1."""
    late = position_in[time_s >= time_s[-1] - 0.25 * (time_s[-1] - time_s[0])]
    final_in = float(late.mean())
    low, high = np.percentile(late, (5, 95))
    outside = np.flatnonzero(np.abs(position_in - target_in) > SETTLED_SHARE * travel_in)
    if not outside.size:
        settled_s: float | None = 0.0
    elif outside[-1] + 1 < time_s.size:
        settled_s = float(time_s[outside[-1] + 1] - time_s[0])
    else:
        settled_s = None
    return TargetResult(target_in, final_in, final_in - target_in, float(high - low), settled_s)
