"""Pressure cannot exceed what the air supply gives."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import EP_CLIP, EP_SUPPLY

_SUPPLY = Parameter(
    name="supply",
    kind="pressure",
    lower=3.0,
    upper=60.0,
    # Close together: a ceiling a little too low costs more than none, and one too high changes nothing.
    starts=tuple(6.0 * 1.02**n for n in range(60)),
    scale=8.0,
    doc="highest pressure the supply gives",
    neutral=60.0,
)


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_SUPPLY] = values[0]


def _clip(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_CLIP] = values[0]


EFFECT = Effect(
    name="supply_saturation",
    stage="ep",
    claim="Pressure cannot exceed what the air supply gives.",
    equations="dp/dt = (min(u, supply) - p) / tau; cut_off: dp/dt = (u - p) / tau and p <= supply",
    source="Goodwin, Graebe, Salgado, Control System Design (Prentice Hall 2001), ch. 11 (saturating actuators)",
    forms=(Form("ceiling", (_SUPPLY,), _apply), Form("cut_off", (_SUPPLY,), _clip)),
    twins=("ep_calibration",),
)
