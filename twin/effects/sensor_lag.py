"""The reading is low-pass filtered."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import S_LAG_S


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_LAG_S] = values[0]


EFFECT = Effect(
    name="sensor_lag",
    stage="sensor",
    claim="The reading is low-pass filtered.",
    equations="dy/dt = (x - y) / lag",
    source="Doebelin, Measurement Systems: Application and Design (McGraw-Hill), first-order instruments",
    forms=(
        Form(
            "first_order",
            (
                Parameter(
                    name="lag",
                    kind="time",
                    lower=0.0,
                    upper=8.0,
                    starts=(0.06, 0.25, 0.9),
                    scale=0.5,
                    doc="time constant of the filter",
                ),
            ),
            _apply,
        ),
    ),
    twins=("additional_lag", "dead_time"),
    absorbs=("tau",),
    same_as={"first_order": ("additional_lag",)},
)
