"""Pressure cannot exceed what the air supply gives."""

from __future__ import annotations

from collections.abc import Sequence

from logs.units import atmosphere
from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import (
    EP_AMBIENT,
    EP_ATMOSPHERE,
    EP_CLIP,
    EP_DRAW,
    EP_KNEE,
    EP_REFILL_S,
    EP_SUBSONIC,
    EP_SUPPLY,
    EP_TANK,
    EP_TANK_CUTS,
)

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


def _soft(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_SUPPLY, EP_KNEE]] = values


def _sinks(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_TANK, EP_DRAW, EP_REFILL_S]] = values


def _sinks_below(c: Coefficients, values: Sequence[float]) -> None:
    _sinks(c, values)
    c.ep[EP_TANK_CUTS] = 1.0


def _clip(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_CLIP] = values[0]


def _subsonic(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_ATMOSPHERE, EP_AMBIENT]] = atmosphere(c.design.pressure_unit)
    c.ep[[EP_CLIP, EP_SUBSONIC]] = values


_WIDTH = Parameter(
    name="width",
    kind="fraction",
    lower=1.0,
    upper=6.0,
    starts=(1.1, 1.6),
    scale=0.5,
    doc="choked flow through the port over what the lag takes",
    neutral=1.0,
    size=False,
)
_DRAW = Parameter(
    name="draw",
    kind="fraction",
    lower=0.0,
    upper=3.0,
    starts=(0.1, 0.4),
    scale=0.3,
    doc="by how much the supply sinks for each unit that the pressure rises",
    size=False,
)
_REFILL = Parameter(
    name="refill",
    kind="time",
    lower=0.5,
    upper=900.0,
    starts=(5.0, 40.0),
    scale=30.0,
    doc="time constant with which the supply comes back",
    neutral=30.0,
    size=False,
)
_KNEE = Parameter(
    name="knee",
    kind="pressure",
    lower=0.0,
    upper=4.0,
    starts=(0.15, 0.6),
    scale=0.5,
    doc="what is missing of the pressure at which the command is the supply, divided by ln 2",
    size=False,
)

EFFECT = Effect(
    name="supply_saturation",
    stage="ep",
    claim="Pressure cannot exceed what the air supply gives.",
    equations="dp/dt = (min(u, supply) - p) / tau; cut_off: dp/dt = (u - p) / tau and p <= supply, "
    "and through a booster only what ISO 6358 lets flow from that supply; "
    "subsonic: where it rises, dp/dt = (u - p) / tau min(1, width flow(p, supply)), flow over choked flow (ISO 6358); "
    "sinking: likewise with supply - s, ds/dt = draw max(dp/dt, 0) - s / refill (a tank behind a restriction); "
    "sinking_cut_off: the same supply, with dp/dt = (u - p) / tau and p <= supply - s; "
    "soft: dp/dt = (v - p) / tau, v = -knee ln(exp(-u / knee) + exp(-supply / knee)) (a regulator that runs out of "
    "pressure difference little by little)",
    source="Goodwin, Graebe, Salgado, Control System Design (Prentice Hall 2001), ch. 11 (saturating actuators); "
    "ISO 6358-1 (flow from a supply)",
    forms=(
        Form("ceiling", (_SUPPLY,), _apply),
        Form("cut_off", (_SUPPLY,), _clip),
        Form("subsonic", (_SUPPLY, _WIDTH), _subsonic),
        Form("soft", (_SUPPLY, _KNEE), _soft),
        Form("sinking", (_SUPPLY, _DRAW, _REFILL), _sinks),
        Form("sinking_cut_off", (_SUPPLY, _DRAW, _REFILL), _sinks_below),
    ),
    twins=("ep_calibration",),
)
