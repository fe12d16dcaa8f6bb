"""Pressure answers a command only after a pure delay."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import EP_DEAD_S


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]


EFFECT = Effect(
    name="dead_time",
    stage="ep",
    claim="Pressure answers a command only after a pure delay.",
    equations="dp/dt = (u(t - d) - p) / tau",
    source="Ljung, System Identification, 2nd ed. (1999), section 4.2",
    forms=(
        Form(
            "pure_delay",
            (
                Parameter(
                    name="delay",
                    kind="time",
                    lower=0.0,
                    upper=10.0,
                    starts=(0.05, 0.15, 0.4, 1.0),
                    scale=0.4,
                    doc="pure delay between command and pressure",
                ),
            ),
            _apply,
        ),
    ),
)
