"""k1 and k2 from a fit that lets the slopes of the two curves differ, and what it means when they do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from control.design import DesignModel
from control.identify_interval import Interval
from control.identify_result import Estimate
from control.identify_spread import lag_shift, spread_of, with_lag
from control.identify_track import Track
from control.identify_valve import Freedom, ValveFit, refit_separate


def slopes(
    tracks: Sequence[Track], fit: ValveFit, freedom: Freedom, unit: str, design: DesignModel, notes: list[str]
) -> list[Estimate]:
    """k1, k2 and the thesis's k_eq, their mean. Where k1 and k2 differ for sure, `notes` get what that does to a1 and
    a2, which the design model has for one slope.
    """
    from scipy.stats import t as student

    found, separate = refit_separate(tracks, fit, freedom)
    spread, rows = spread_of(tracks, found, separate)
    spread = with_lag(spread, lag_shift(tracks, found, separate))
    k1, k2 = float(found.numbers[2]), float(found.numbers[3])
    both = spread[2:4, 2:4]
    reach = float(student.ppf(0.975, rows)) * np.sqrt([both[0, 0], both[1, 1], 0.25 * both.sum()])
    values = {"k1": k1, "k2": k2, "k_eq": 0.5 * (k1 + k2)}
    estimates = []
    for (name, value), half in zip(values.items(), reach, strict=True):
        known = bool(np.isfinite(half) and half < 0.5 * value)
        interval = Interval(value, value - float(half), value + float(half)) if known else None
        kept = Estimate(name, design.compliance, None, unit, "kept", "its curve is not in the record")
        estimates.append(Estimate(name, value, interval, unit, "fit") if known else kept)
    first, second = estimates[0].interval, estimates[1].interval
    if first and second and (first.low > second.high or second.low > first.high):
        a1, a2 = float(found.numbers[0]), float(found.numbers[1])
        notes.append(_differ(k1, k2, a1, a2, design))
    return estimates


def _differ(k1: float, k2: float, a1: float, a2: float, design: DesignModel) -> str:
    """The sentence for curves that are not parallel: with slopes of their own they begin at `a1` and `a2`."""
    unit, travel, spoken = design.pressure_unit, design.travel, design.spoken
    closed = a1 - a2 + travel * (1.0 / k1 - 1.0 / k2)
    begin = f"a1 = {spoken.value(a1, unit):.4g} and a2 = {spoken.text(a2, unit, 4)}"
    return (
        f"k1 and k2 differ by {200.0 * abs(k1 - k2) / (k1 + k2):.2g} %: the curves are not parallel, and the rows a1, "
        "a2, deadband and compliance, which go into the model, are a compromise of one slope. With slopes of their own "
        f"the curves begin at {begin}, and the deadband is {spoken.text(a1 - a2, unit, 4)} at the open end and "
        f"{spoken.text(closed, unit, 4)} at the closed end; `diagnose` names causes (spring_asymmetry)"
    )
