"""Pressure cannot change faster than the flow capacity of the converter allows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from logs.units import atmosphere
from twin.kernels.ep_slots import (
    EP_AIR,
    EP_AMBIENT,
    EP_ATMOSPHERE,
    EP_FULL_DOWN,
    EP_FULL_UP,
    EP_MIDDLE,
    EP_NOMINAL,
    EP_OPEN,
    EP_RATE_DOWN,
    EP_RATE_UP,
    EP_REFERENCE,
    EP_SLEW,
    EP_STROKE,
)
from twin.kernels.slots import FOREVER
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

#: Error at which a booster is fully open, as a share of the pressure that the travel takes: a tenth of a psi.
_WIDE = 0.034
#: The usual supply of instruments [atmospheres], and over the highest signal (IEC 60382: 140 kPa, 20 to 100 kPa).
_SUPPLY, _OVER = 1.38, 1.4


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


def _through(name: str, doc: str) -> Parameter:
    return replace(_slowness(name, doc), starts=(0.1, 0.4, 1.2))


_AIR = Parameter(
    name="air",
    kind="fraction",
    lower=0.0,
    upper=8.0,
    starts=(0.2, 1.5),
    scale=2.0,
    doc="volume that the stem sweeps over the chamber's with the stem open",
    size=False,
)

_STROKE = Parameter(
    name="stroke",
    kind="fraction",
    lower=-1.0,
    upper=4.0,
    starts=(0.1, -0.1, 0.5),
    scale=0.1,
    doc="what a sudden full stroke takes from the pressure, as a share of what moves the stem over its travel",
)


def _rate(slowness: float) -> float:
    return 1.0 / slowness if slowness > 1.0 / FOREVER else FOREVER


def _symmetric(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_RATE_UP, EP_RATE_DOWN]] = _rate(values[0])


def _two_rates(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_RATE_UP] = _rate(values[0])
    c.ep[EP_RATE_DOWN] = _rate(values[1])


def _ramped(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_SLEW] = _rate(values[0])


def _orifices(c: Coefficients, values: Sequence[float]) -> None:
    if min(values[:2]) <= 1.0 / FOREVER:
        return
    d = c.design
    c.ep[[EP_ATMOSPHERE, EP_AMBIENT]] = atmosphere(d.pressure_unit)
    c.ep[EP_REFERENCE] = max(d.offset, c.ep[EP_AMBIENT] + 0.1 * c.ep[EP_ATMOSPHERE])
    c.ep[[EP_FULL_UP, EP_FULL_DOWN]] = _rate(values[0]), _rate(values[1])
    c.ep[EP_NOMINAL] = max(_SUPPLY * c.ep[EP_ATMOSPHERE] + c.ep[EP_AMBIENT], _OVER * (d.a1 + d.travel / d.compliance))
    c.ep[EP_OPEN] = _WIDE * d.travel / d.compliance
    c.ep[[EP_AIR, EP_MIDDLE]] = values[2] / d.travel, 0.5 * d.travel


def _stroke(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_STROKE] = values[0] / c.design.compliance


EFFECT = Effect(
    name="ep_rate_limit",
    stage="ep",
    claim="The slope of the pressure is bounded by flow capacity.",
    equations="|dp/dt| <= 1 / slowness; ramped: the goal of the lag moves no faster than 1 / slowness; orifices: "
    "V dp/dt = flow - (p + p_a) dV/dt, V = (1 + air * x / travel) / (1 + air / 2); flow: 1 / slowness_up rising, "
    "falling with ISO 6358's outflow at p over that at the offset; in proportion near the goal; a stroke that moves "
    "the pressure limits no rate, it only resembles it: dp/dt = (u - p) / tau - stroke / k dx/dt",
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
        Form("ramped", (_slowness("slowness", "least time per unit of pressure of what it aims at"),), _ramped),
        Form(
            "orifices",
            (
                _through("slowness_up", "least time per unit of pressure when rising, with the stem in the middle"),
                _through("slowness_down", "the same when falling from the middle of the two curves"),
                _AIR,
            ),
            _orifices,
            by_pressure=True,
        ),
        Form("stroke", (_STROKE,), _stroke, by_pressure=True, outside="the stroke of the stem moves the pressure"),
    ),
    twins=("fill_exhaust_asymmetry",),
    absorbs=("ep_tau",),
)
