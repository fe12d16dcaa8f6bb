"""Pressure answers a command only after a pure delay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import EP_DAMPING, EP_DEAD_FALLS, EP_DEAD_S, EP_MIXED_S, EP_RINGS_S


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]


def _spreads(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]
    c.ep[EP_MIXED_S] = values[0] * values[1]


def _each_way(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_DEAD_S] = values[0]
    c.ep[EP_DEAD_FALLS] = values[1] - values[0]


def _rings(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_RINGS_S, EP_DAMPING]] = values


_DELAY = Parameter(
    name="delay",
    kind="time",
    lower=0.0,
    upper=10.0,
    starts=(0.05, 0.15, 0.4, 1.0),
    scale=0.4,
    doc="pure delay between command and pressure",
)
_RISING = replace(_DELAY, name="rising", doc="pure delay between a rising command and the pressure")
_FALLING = replace(_DELAY, name="falling", doc="the same of a falling one")
_SPREAD = Parameter(
    name="spread",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.1, 0.4),
    scale=0.3,
    doc="time constant with which what comes out of the delay is mixed, as a share of it",
    size=False,
)
_SWING = Parameter(
    name="swing",
    kind="time",
    lower=0.0,
    upper=5.0,
    starts=(0.1, 0.3, 0.8),
    scale=0.4,
    doc="period of its swing over 2 pi",
)
_DAMPING = Parameter(
    name="damping",
    kind="fraction",
    lower=0.02,
    upper=0.6,
    starts=(0.15, 0.4),
    scale=0.3,
    doc="damping ratio of the swing",
    neutral=0.3,
    size=False,
)

EFFECT = Effect(
    name="dead_time",
    stage="ep",
    claim="Pressure answers a command only after a pure delay.",
    equations="dp/dt = (u(t - d) - p) / tau; dispersed: u(t - d) through a lag of spread d first; each_way: the larger "
    "of u(t - rising) and u(t - falling) where falls take longer, else the smaller; only told from it: "
    "a pilot v before the lag that swings, swing^2 v'' + 2 damping swing v' + v = u",
    source="Ljung, System Identification, 2nd ed. (1999), section 4.2; Levenspiel, Chemical Reaction Engineering, "
    "3rd ed. (1999), ch. 12 (plug flow and mixed flow in series)",
    forms=(
        Form("pure_delay", (_DELAY,), _apply),
        Form("dispersed", (_DELAY, _SPREAD), _spreads),
        Form("each_way", (_RISING, _FALLING), _each_way),
        Form("rings", (_SWING, _DAMPING), _rings, by_pressure=True, outside="the converter swings to its goal"),
    ),
)
