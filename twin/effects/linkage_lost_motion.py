"""Play between the stem and the LVDT core."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import S_PLAY


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_PLAY] = values[0]


EFFECT = Effect(
    name="linkage_lost_motion",
    stage="sensor",
    claim="There is play between the stem and the LVDT core.",
    equations="y = max(x - play/2, min(x + play/2, y))",
    source="Nordin, Gutman, Automatica 38 (2002) 1633; Tao, Kokotovic, Adaptive Control of Systems with Actuator and "
    "Sensor Nonlinearities (Wiley 1996)",
    forms=(
        Form(
            "play",
            (
                Parameter(
                    name="play",
                    kind="position",
                    lower=0.0,
                    upper=0.15,
                    starts=(0.002, 0.006, 0.02),
                    scale=0.01,
                    doc="full width of the lost motion",
                ),
            ),
            _apply,
        ),
    ),
    twins=("friction_in_motion",),
    absorbs=("deadband",),
)
