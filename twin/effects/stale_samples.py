"""The DAQ refreshes more slowly than it is polled: readings repeat."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import S_HOLD_PHASE_S, S_HOLD_S

_PERIOD = Parameter(
    name="period",
    kind="time",
    lower=0.0,
    upper=60.0,
    starts=(0.1, 4.0),  # tried densely in between
    scale=1.0,
    doc="time between two refreshes",
    smooth=False,
)
_PHASE = Parameter(
    name="phase",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.0, 0.25, 0.5, 0.75),
    scale=0.3,
    doc="time of the first refresh after the first row, fraction of the period",
    smooth=False,
    size=False,
)


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_HOLD_S] = values[0]
    c.sensor[S_HOLD_PHASE_S] = values[0] * values[1]


EFFECT = Effect(
    name="stale_samples",
    stage="sensor",
    claim="The DAQ refreshes the reading more slowly than it is polled.",
    equations="y(t) = x(n period + phase) until the next refresh",
    source="Astrom, Wittenmark, Computer-Controlled Systems, 3rd ed. (Prentice Hall 1997), ch. 7 (sample and hold)",
    forms=(Form("periodic", (_PERIOD, _PHASE), _apply),),
    twins=("sensor_lag",),
)
