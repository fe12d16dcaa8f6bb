"""Pressure cannot change faster than the flow capacity of the converter allows."""

from __future__ import annotations

from collections.abc import Sequence

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.slots import EP_RATE_DOWN, EP_RATE_UP, FOREVER


def _slowness(name: str, doc: str) -> Parameter:
    # The reciprocal of the rate: no limit is 0, and a tighter limit is a larger number. A limit that is not reached has
    # no slope to follow, and one that is too tight is worse than none: the starts are close to each other.
    return Parameter(
        name=name,
        kind="time_per_pressure",
        lower=0.0,
        upper=20.0,
        starts=(0.15, 0.5, 1.2, 2.0, 2.8, 4.0, 6.0),
        scale=0.5,
        doc=doc,
    )


def _rate(slowness: float) -> float:
    return 1.0 / slowness if slowness > 1.0 / FOREVER else FOREVER


def _symmetric(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_RATE_UP, EP_RATE_DOWN]] = _rate(values[0])


def _two_rates(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_RATE_UP] = _rate(values[0])
    c.ep[EP_RATE_DOWN] = _rate(values[1])


EFFECT = Effect(
    name="ep_rate_limit",
    stage="ep",
    claim="The slope of the pressure is bounded by flow capacity.",
    equations="|dp/dt| <= 1 / slowness",
    source="Andersen, The Analysis and Design of Pneumatic Systems (Wiley 1967); ISO 6358-1 (choked flow)",
    forms=(
        Form("symmetric", (_slowness("slowness", "least time per unit of pressure, 1 / rate limit"),), _symmetric),
        Form(
            "up_and_down",
            (
                _slowness("slowness_up", "least time per unit of pressure when rising"),
                _slowness("slowness_down", "least time per unit of pressure when falling"),
            ),
            _two_rates,
        ),
    ),
    twins=("fill_exhaust_asymmetry",),
    absorbs=("ep_tau",),
)
