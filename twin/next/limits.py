"""What an experiment may do here: the pressures that the records have seen or a full stroke needs, and the clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from control.design import DesignModel
from logs.recording import Recording
from logs.units import PERCENT, conversion, plain_name

#: Pressure beyond a curve's end that makes sure of the stop, as a share of the stroke's pressure span.
_MARGIN = 0.1
#: Sampling periods that a bench with a serial wire can keep [s].
_FASTEST_S, _SLOWEST_S = 0.05, 0.5
#: Commands outside these quantiles of a record were passed through, not kept.
_KEPT = (0.02, 0.98)


@dataclass(frozen=True, slots=True)
class Limits:
    """Commands from `low` to `high` in `unit` ("psi" or "percent"); `scale` turns them into the record's pressure unit.

    `middle` is the command in the middle of the loop, `span` what a full stroke takes on one curve, `deadband` the
    width of the loop, `settle_s` the time after which a step is over.
    """

    unit: str
    scale: float
    low: float
    high: float
    middle: float
    span: float
    deadband: float
    settle_s: float
    stroke_s: float
    period_s: float


def limits_of(design: DesignModel, recordings: Sequence[Recording]) -> Limits:
    """The limits for a bench from which these recordings came, in the design's units.

    Low and high are the hull of the commands that the valve was kept at and of the full stroke on both curves with a
    margin, within what the bench allows where a record says so.
    """
    percent = plain_name(design.pressure_unit) == PERCENT
    unit = "percent" if percent else "psi"
    scale = 1.0 if percent else conversion("psi", "pressure").scale / conversion(design.pressure_unit, "pressure").scale
    span = design.travel / design.compliance
    kept = [np.quantile(r.command[np.isfinite(r.command)], _KEPT) for r in recordings]
    low = min([design.a2 - _MARGIN * span, *(float(ends[0]) for ends in kept)])
    high = max([design.a1 + (1.0 + _MARGIN) * span, *(float(ends[1]) for ends in kept)])
    allowed = [_allowed(r) for r in recordings]
    low = max([low / scale, 0.0, *(ends[0] for ends in allowed)])
    high = min([high / scale, 100.0 if percent else float("inf"), *(ends[1] for ends in allowed)])
    period_s = float(np.median([r.period_s for r in recordings])) if recordings else 0.1
    return Limits(
        unit=unit,
        scale=scale,
        low=low,
        high=high,
        middle=(design.offset + 0.5 * span) / scale,
        span=span / scale,
        deadband=design.deadband / scale,
        settle_s=max(design.tau_s + design.ep_tau_s, 2.0 * period_s),
        stroke_s=design.travel / design.rate_limit,
        period_s=float(np.clip(round(period_s, 4), _FASTEST_S, _SLOWEST_S)),
    )


def _allowed(recording: Recording) -> tuple[float, float]:
    """The bench's range of commands, in its own unit, from the start document of a run; anything for other files."""
    run = recording.meta.get("run")
    bench = run.get("bench") if isinstance(run, Mapping) else None
    if not isinstance(bench, Mapping):
        return float("-inf"), float("inf")
    return float(bench.get("command_min", "-inf")), float(bench.get("command_max", "inf"))
