"""The zero of the reading moves gradually with time."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import S_DRIFT_AMP, S_DRIFT_RATE, S_DRIFT_TAU_S

_RATE = Parameter(
    name="rate",
    kind="position_rate",
    lower=-1e-3,
    upper=1e-3,
    starts=(-1e-5, 1e-5),
    scale=3e-5,
    doc="drift of the zero per second",
)
_CHANGE = Parameter(
    name="change",
    kind="position",
    lower=-0.15,
    upper=0.15,
    starts=(-0.004, 0.004),
    scale=0.01,
    doc="change of the zero in the end",
)
_SETTLING = Parameter(
    name="settling",
    kind="time",
    lower=10.0,
    upper=5000.0,
    starts=(60.0, 300.0),
    scale=150.0,
    doc="time constant of the warm-up",
    neutral=200.0,
    size=False,
)


def _linear(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_DRIFT_RATE] = values[0]


def _warm_up(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_DRIFT_AMP] = values[0]
    c.sensor[S_DRIFT_TAU_S] = values[1]


EFFECT = Effect(
    name="lvdt_drift",
    stage="sensor",
    claim="The zero of the reading moves gradually with time.",
    equations="y = x + rate t, or y = x + change (1 - exp(-t / settling))",
    source="IEC 61298-3, Process measurement and control devices, part 3 (effects of influence quantities)",
    forms=(Form("linear", (_RATE,), _linear), Form("warm_up", (_CHANGE, _SETTLING), _warm_up)),
    twins=("friction_drift", "creep"),
)
