"""Fluid through the valve pushes the plug, depending on opening."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import FloatArray
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter
from twin.model.shapes import bow, detrended

#: Opening (fraction of travel) over which a force at the seat falls to 1/e, and about which one near it may peak.
PEAK = 0.12


def _force(doc: str) -> tuple[Parameter]:
    return (
        Parameter(
            name="force",
            kind="pressure",
            lower=-3.0,
            upper=3.0,
            starts=(-0.3, -0.05, 0.05, 0.3),
            scale=0.3,
            doc=doc,
        ),
    )


_WITHIN = Parameter(
    name="within",
    kind="fraction",
    lower=0.02,
    upper=0.6,
    starts=(0.06, 0.25),
    scale=0.1,
    doc="opening over which the force falls to 1/e",
    neutral=0.12,
    size=False,
)


_HALVED = Parameter(
    name="halved",
    kind="fraction",
    lower=0.05,
    upper=1.5,
    starts=(0.2, 0.5),
    scale=0.2,
    doc="opening at which the line has as much of the pressure drop as the plug",
    neutral=0.3,
    size=False,
)

_AT = Parameter(
    name="at",
    kind="fraction",
    lower=0.03,
    upper=0.8,
    starts=(PEAK, 0.35),
    scale=0.1,
    doc="opening at which the force peaks",
    neutral=PEAK,
    size=False,
)

_SKEW = Parameter(
    name="skew",
    kind="fraction",
    lower=-1.2,  # beyond 1 it would pull near one end and push near the other
    upper=1.2,
    starts=(-0.6, 0.6),
    scale=0.5,
    doc="by how much of itself the force is greater near the seat, and less near fully open, than without",
    size=False,
)


def _push(c: Coefficients, shape: FloatArray) -> None:
    # Without its straight line: that part re-tunes offset and compliance and says nothing about the fluid.
    c.shift(detrended(shape, c.xi))


def _throttling(c: Coefficients, values: Sequence[float]) -> None:
    _push(c, values[0] * np.square(c.xi))


def _of_jet(c: Coefficients, values: Sequence[float]) -> FloatArray:
    opening = (1.0 - c.xi) / values[1]
    return values[0] * opening * np.exp(1.0 - opening)


def _jet(c: Coefficients, values: Sequence[float]) -> None:
    _push(c, _of_jet(c, values))


def _stem_jet(c: Coefficients, values: Sequence[float]) -> None:
    _push_stem(c, _of_jet(c, values))


def _of_drop(c: Coefficients, values: Sequence[float]) -> FloatArray:
    # A plug and a line in series share the pressure as the inverse squares of what they let through.
    return values[0] / (1.0 + np.square((1.0 - c.xi) / values[1]))


def _drop(c: Coefficients, values: Sequence[float]) -> None:
    _push(c, _of_drop(c, values))


def _stem_drop(c: Coefficients, values: Sequence[float]) -> None:
    _push_stem(c, _of_drop(c, values))


def _push_stem(c: Coefficients, shape: FloatArray) -> None:
    # With its straight line: a force that follows the stem, and not the play, is more than another compliance.
    c.bend_at_stem(shape, shape)


def _stem_linear(c: Coefficients, values: Sequence[float]) -> None:
    _push_stem(c, values[0] * c.xi)


def _stem_square(c: Coefficients, values: Sequence[float]) -> None:
    _push_stem(c, values[0] * np.square(c.xi))


def _stem_hump(c: Coefficients, values: Sequence[float]) -> None:
    # A larger opening passes more and leaves less of the pressure drop: most force is in the middle.
    _push_stem(c, values[0] * bow(c.xi))


def _lopsided(xi: FloatArray, skew: float) -> FloatArray:
    return bow(xi) * (1.0 + skew * (2.0 * xi - 1.0))


def _peak(c: Coefficients, values: Sequence[float]) -> None:
    # Nothing at either end, where offset and compliance are told: with no line of its own to take off.
    c.shift(values[0] * _lopsided(c.xi, values[1]))


def _stem_peak(c: Coefficients, values: Sequence[float]) -> None:
    _push_stem(c, values[0] * _lopsided(c.xi, values[1]))


def _stem_seat(c: Coefficients, values: Sequence[float]) -> None:
    _stem_suction(c, (values[0], PEAK))


def _stem_suction(c: Coefficients, values: Sequence[float]) -> None:
    _push_stem(c, values[0] * np.exp(-(1.0 - c.xi) / values[1]))


def _suction(c: Coefficients, values: Sequence[float]) -> None:
    _push(c, values[0] * np.exp(-(1.0 - c.xi) / values[1]))


def _at_seat(c: Coefficients, values: Sequence[float]) -> None:
    _suction(c, (values[0], PEAK))


_ON_THE_WAY = "force at half opening, none at either end, as pressure"
#: Three to one against a bent spring, with `odds` below: of the last five such pushes that strangers and blind checks
#: had, nothing at both ends and greatest nearer one, four were a fluid's.
_LOPSIDED = 60.0

EFFECT = Effect(
    name="flow_force",
    stage="actuator",
    claim="Fluid through the valve pushes the plug, depending on opening.",
    equations="closing p = a1 + w/k + f(w), opening p = a2 + w/k + f(w); f = force * shape(opening) less its line; "
    "shape: (1 - opening)^2, or 4 opening (1 - opening) (hump), or exp(-opening/0.12) (at_seat, stem_seat), "
    "suction: exp(-opening/within), jet: o/at exp(1 - o/at), drop: 1 / (1 + (o/halved)^2), "
    "peak: 4 o (1 - o) (1 + skew (1 - 2 o)), o the opening, with its line; stem_*: f of the stem x, with its line",
    source="Merritt, Hydraulic Control Systems (Wiley 1967), ch. 5; Borden (ed.), Control Valves (ISA 1998)",
    forms=(
        Form("throttling", _force("force growing with the square of closure, at closed, as pressure"), _throttling),
        Form("jet", (*_force("peak of the force, as pressure"), _AT), _jet),
        Form("drop", (*_force("force at the seat, as pressure"), _HALVED), _drop),
        Form("at_seat", _force("force at the seat, dying away within 12 % opening, as pressure"), _at_seat),
        Form("suction", (*_force("force at the seat, dying away with opening, as pressure"), _WITHIN), _suction),
        Form("stem_linear", _force("force at closed, growing in proportion to closure, as pressure"), _stem_linear),
        Form("stem_square", _force("force at closed, growing with the square of closure, as pressure"), _stem_square),
        Form("stem_hump", _force("force at half opening, none at either end, as pressure"), _stem_hump),
        Form("peak", (*_force(_ON_THE_WAY), _SKEW), _peak, odds=_LOPSIDED),
        Form("stem_peak", (*_force(_ON_THE_WAY), _SKEW), _stem_peak, odds=_LOPSIDED),
        Form("stem_seat", _force("force at the seat, dying away within 12 % opening, as pressure"), _stem_seat),
        Form(
            "stem_suction", (*_force("force at the seat, dying away with opening, as pressure"), _WITHIN), _stem_suction
        ),
        Form("stem_jet", (*_force("peak of the force, as pressure"), _AT), _stem_jet),
        Form("stem_drop", (*_force("force at the seat, as pressure"), _HALVED), _stem_drop),
    ),
    twins=("nonlinear_spring", "lvdt_nonlinearity"),
    odds=0.05,  # most benches are dry
    absorbs=("compliance", "offset"),
    same_as=dict.fromkeys(
        (
            "throttling",
            "jet",
            "drop",
            "at_seat",
            "suction",
            "peak",
            "stem_square",
            "stem_hump",
            "stem_peak",
            "stem_seat",
            "stem_suction",
            "stem_jet",
            "stem_drop",
        ),
        ("nonlinear_spring",),
    ),
)
