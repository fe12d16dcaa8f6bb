"""Coarse resolution of the reading."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import S_STEP


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_STEP] = values[0]


EFFECT = Effect(
    name="sensor_quantization",
    stage="sensor",
    claim="The reading has a coarse resolution.",
    equations="y = step * round(x / step)",
    source="Widrow, Kollar, Quantization Noise (Cambridge 2008)",
    forms=(
        Form(
            "uniform_steps",
            (
                Parameter(
                    name="step",
                    kind="position",
                    lower=0.0,
                    upper=0.1,
                    starts=(0.001, 0.003, 0.01),
                    scale=0.005,
                    doc="distance of neighbouring readings",
                    smooth=False,
                ),
            ),
            _apply,
        ),
    ),
    evidence="events",
)
