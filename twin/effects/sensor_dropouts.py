"""Isolated false readings."""

from __future__ import annotations

from collections.abc import Sequence

from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter


def _apply(_c: Coefficients, _values: Sequence[float]) -> None:
    # Which readings are false is chance: the expected trajectory does not change, the events in the reading do.
    return


EFFECT = Effect(
    name="sensor_dropouts",
    stage="sensor",
    claim="Isolated readings are false.",
    equations="y = x, but false with probability rate, independently of the neighbours",
    source="Huber, Robust Statistics (Wiley 1981), ch. 1 (gross errors)",
    forms=(
        Form(
            "isolated",
            (
                Parameter(
                    name="rate",
                    kind="fraction",
                    lower=0.0,
                    upper=0.5,
                    starts=(0.001, 0.01, 0.05),
                    scale=0.01,
                    doc="probability that a reading is false",
                    smooth=False,
                ),
            ),
            _apply,
        ),
    ),
    evidence="events",
)
