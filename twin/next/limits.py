"""What an experiment may do here: the pressures that the records have seen or a full stroke needs, and the clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from control.design import DesignModel
from logs.recording import Recording
from logs.units import PERCENT, conversion, plain_name

#: Pressure beyond a curve's end that makes sure of the stop, as a share of the stroke's pressure span.
_MARGIN = 0.1
#: Sampling periods that a bench with a serial wire can keep [s].
_FASTEST_S, _SLOWEST_S = 0.05, 0.5


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

    Low and high are the hull of all commands that were recorded and of the full stroke on both curves with a margin.
    """
    percent = plain_name(design.pressure_unit) == PERCENT
    unit = "percent" if percent else "psi"
    scale = 1.0 if percent else conversion("psi", "pressure").scale / conversion(design.pressure_unit, "pressure").scale
    span = design.travel / design.compliance
    seen = [r.command[np.isfinite(r.command)] for r in recordings]
    low = min([design.a2 - _MARGIN * span, *(float(c.min()) for c in seen if c.size)])
    high = max([design.a1 + (1.0 + _MARGIN) * span, *(float(c.max()) for c in seen if c.size)])
    period_s = float(np.median([r.period_s for r in recordings])) if recordings else 0.1
    return Limits(
        unit=unit,
        scale=scale,
        low=max(low, 0.0) / scale,
        high=(min(high, 100.0) if percent else high) / scale,
        middle=(design.offset + 0.5 * span) / scale,
        span=span / scale,
        deadband=design.deadband / scale,
        settle_s=max(design.tau_s + design.ep_tau_s, 2.0 * period_s),
        stroke_s=design.travel / design.rate_limit,
        period_s=float(np.clip(round(period_s, 4), _FASTEST_S, _SLOWEST_S)),
    )
