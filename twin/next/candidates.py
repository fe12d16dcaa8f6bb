"""The library of safe experiments: every kind that `sweep` knows, in several sizes, within the limits of the bench.

Amplitudes, rates and dwells are stated in units of the valve: its stroke in pressure, its settling time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from control.experiment import Experiment
from control.experiment_catalog import make_experiment
from hal.errors import BadInput
from twin.next.limits import Limits

LONGEST_S = 1800.0
#: What may be made larger or smaller, per kind, besides the levels.
FREE: Mapping[str, tuple[str, ...]] = {
    "staircase": ("step", "dwell_s"),
    "nested": ("smallest", "loops", "dwell_s"),
    "ramp": ("rate_per_s", "dwell_s"),
    "steps": ("heights", "dwell_s"),
    "random": ("count", "dwell_max_s", "dwell_min_s"),
    "multisine": ("amplitude", "base_s", "highest_hz"),
    "hold": ("hold_s",),
}


def library(limits: Limits) -> list[Experiment]:
    """All experiments of the library that can be made within the limits, in a fixed order."""
    made = (_made(kind, settings, limits) for kind, settings in _settings(limits))
    return [one for one in made if one is not None]


def neighbours(experiment: Experiment, limits: Limits) -> list[Experiment]:
    """The same experiment with one of its free numbers larger or smaller, and with narrower levels."""
    found = []
    for name in FREE.get(experiment.kind, ()):
        value = getattr(experiment, name)
        for factor in (0.6, 1.6):
            changed = max(2, round(value * factor)) if isinstance(value, int) else value * factor
            found.append(_changed(experiment, limits, **{name: changed}))
    if hasattr(experiment, "low") and hasattr(experiment, "high"):
        reach = experiment.high - experiment.low
        found.append(_changed(experiment, limits, high=experiment.high - 0.25 * reach))
        found.append(_changed(experiment, limits, low=experiment.low + 0.25 * reach))
    return [one for one in found if one is not None and one != experiment]


def repeated(experiment: Experiment, times: int) -> Experiment:
    """The experiment with its pass repeated, after one conditioning stroke."""
    return replace(experiment, repeats=experiment.repeats * times)


def _changed(experiment: Experiment, limits: Limits, **values: float) -> Experiment | None:
    try:
        changed = replace(experiment, **values)  # type: ignore[arg-type]
    except BadInput:
        return None
    return changed if _fits(changed, limits) else None


def _made(kind: str, settings: Mapping[str, object], limits: Limits) -> Experiment | None:
    try:
        experiment = make_experiment(kind, {**_common(limits), **settings})
    except BadInput:
        return None
    return experiment if _fits(experiment, limits) else None


def _fits(experiment: Experiment, limits: Limits) -> bool:
    low, high = experiment.range
    slack = 1e-9 * (limits.high - limits.low)
    return limits.low - slack <= low and high <= limits.high + slack and experiment.duration_s <= LONGEST_S


def _common(limits: Limits) -> dict[str, object]:
    return {
        "unit": limits.unit,
        "period_s": limits.period_s,
        "conditioning_low": limits.low,
        "conditioning_high": limits.high,
        "conditioning_s": round(limits.stroke_s + 5.0 * limits.settle_s, 1),
    }


def _settings(limits: Limits) -> Iterator[tuple[str, dict[str, object]]]:
    low, high, settle = limits.low, limits.high, limits.settle_s
    reach = high - low
    ends = {"low": low, "high": high}
    for parts, dwell in ((12, 4.0), (24, 2.0), (36, 4.0)):
        yield "staircase", {**ends, "step": reach / parts, "dwell_s": dwell * settle}
    for seconds in (30.0, 120.0, 400.0):
        yield "ramp", {**ends, "rate_per_s": reach / seconds, "dwell_s": 4.0 * settle}
    centre = min(max(limits.middle, low + 0.4 * reach), high - 0.4 * reach)
    for loops, smallest, dwell in ((4, 0.2, 1.0), (6, 0.2, 1.5), (8, 0.05, 0.5), (10, 0.4, 1.0)):
        yield "nested", {**ends, "centre": centre, "smallest": smallest * reach, "loops": loops,
                         "step": reach / 24, "dwell_s": dwell * settle}  # fmt: skip
    for heights, dwell in ((2, 5.0), (4, 4.0), (6, 8.0), (2, 40.0)):
        yield "steps", {**ends, "heights": heights, "dwell_s": dwell * settle}
    for count, least, most in ((40, 0.2, 1.0), (60, 0.5, 3.0), (40, 1.0, 8.0)):
        yield "random", {**ends, "count": count, "dwell_min_s": least * settle, "dwell_max_s": most * settle}
    half = min(centre - low, high - centre)
    for share, base, highest in ((1.0, 100.0, 0.1), (0.5, 100.0, 0.3), (1.0, 300.0, 0.03)):
        yield "multisine", {"centre": centre, "amplitude": share * half, "base_s": base, "highest_hz": highest,
                            "periods": 2}  # fmt: skip
    yield "hold", {"at": limits.middle + 0.5 * limits.deadband, "hold_s": 900.0}
    yield "points", {"points": _bursts(limits, rest_s=300.0)}
    yield "points", {"points": _bursts(limits, rest_s=60.0)}
    yield "points", {"points": _dither(limits)}


def _bursts(limits: Limits, rest_s: float) -> list[list[float]]:
    """The same strokes at once and after rests: what needs time, or wears, shows as a difference."""
    stay_s = limits.stroke_s + 3.0 * limits.settle_s
    strokes = [[limits.high, 0.0, stay_s], [limits.low, 0.0, stay_s]] * 3
    return [*strokes, [limits.middle, 0.0, rest_s], *strokes, [limits.middle, 0.0, rest_s]]


def _dither(limits: Limits) -> list[list[float]]:
    """Quick small steps on the closing curve at three places: delays against lags."""
    rows: list[list[float]] = []
    for share in (0.2, 0.5, 0.8):
        foot = limits.middle + 0.5 * limits.deadband + (share - 0.5) * limits.span
        for step in (0.1, 0.2, 0.1, 0.3):
            stay_s = limits.settle_s * (0.4 + 6.0 * step)
            level = min(foot + step * limits.span, limits.high)
            rows += [[level, 0.0, stay_s], [max(foot - limits.deadband - step * limits.span, limits.low), 0.0, stay_s]]
    return rows
