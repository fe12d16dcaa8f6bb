"""Compliance depends on position: the spring stiffens or the effective diaphragm area changes over the stroke."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from twin.effect import Coefficients, Effect, Form, Parameter
from twin.shapes import bow, swing


def _parameter(name: str, doc: str) -> Parameter:
    return Parameter(
        name=name,
        kind="pressure",
        lower=-1.5,
        upper=1.5,
        starts=(-0.25, 0.25),
        scale=0.25,
        doc=doc,
    )


def _bow(c: Coefficients, values: Sequence[float]) -> None:
    shift = values[0] * bow(c.xi)
    c.close_shift += shift
    c.open_shift += shift


def _bow_and_swing(c: Coefficients, values: Sequence[float]) -> None:
    _bow(c, values)
    shift = values[1] * swing(c.xi)
    c.close_shift += shift
    c.open_shift += shift


def _stem_bow(c: Coefficients, values: Sequence[float]) -> None:
    shift = values[0] * bow(c.xi)
    c.bend_at_stem(shift, shift)


def _stem_bow_and_swing(c: Coefficients, values: Sequence[float]) -> None:
    _stem_bow(c, values)
    shift = values[1] * swing(c.xi)
    c.bend_at_stem(shift, shift)


def _stem_slope(c: Coefficients, values: Sequence[float]) -> None:
    nothing = np.zeros_like(c.xi)
    c.bend_at_stem(nothing, nothing, 1.0 + values[0] * (c.xi - 0.5))


def _area(c: Coefficients, share: np.ndarray) -> None:
    """Where the diaphragm's area is larger by `share`, every pressure pulls more: spring and friction alike."""
    spring = c.xi * c.design.travel / c.design.compliance
    c.close_shift += (c.design.a1 + spring) * (1.0 / (1.0 + share) - 1.0)
    c.open_shift += (c.design.a2 + spring) * (1.0 / (1.0 + share) - 1.0)


def _area_slope(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * (c.xi - 0.5))


def _area_bow(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * bow(c.xi))


def _area_slope_and_bow(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * (c.xi - 0.5) + values[1] * bow(c.xi))


def _stem_area(c: Coefficients, values: Sequence[float]) -> None:
    # k (p (1 + share) - a - x / k) is (1 + share) k (p - a / (1 + share)) - x
    larger = 1.0 + values[0] * (c.xi - 0.5)
    c.bend_at_stem(c.design.a1 * (1.0 / larger - 1.0), c.design.a2 * (1.0 / larger - 1.0), larger)


_BOW = _parameter("bow", "extra pressure needed at mid travel, on both curves")
_SWING = _parameter("swing", "amplitude of the S-shaped part: extra pressure at 21 % of travel, less at 79 %")

_SLOPE = Parameter(
    name="slope",
    kind="fraction",
    lower=-0.9,
    upper=0.9,
    starts=(-0.2, -0.03, 0.03, 0.2),
    scale=0.2,
    doc="change of the compliance from fully open to fully closed, as a share of that at mid travel",
)

_AREA = Parameter(
    name="area",
    kind="fraction",
    lower=-0.3,
    upper=0.3,
    starts=(-0.01, 0.01),
    scale=0.03,
    doc="change of the effective area from fully open to fully closed, as a share",
)
_AREA_MID = replace(_AREA, doc="excess of the effective area at mid travel, as a share")

EFFECT = Effect(
    name="nonlinear_spring",
    stage="actuator",
    claim="Compliance depends on position.",
    equations="closing p = a1 + w/k + s(w), opening p = a2 + w/k + s(w), s = bow * 4 xi (1 - xi) + swing * S(xi); "
    "stem_*: s of the stem x; stem_slope: k (1 + slope (x/travel - 1/2)); "
    "area_*: p (1 + area (xi - 1/2) + area_mid 4 xi (1 - xi)) in place of p, xi = w/travel; stem_area: x/travel",
    source="actuator data sheets (effective area over stroke; spring ranges such as 3 to 15 psi)",
    forms=(
        Form("bow", (_BOW,), _bow),
        Form("bow_and_swing", (_BOW, _SWING), _bow_and_swing),
        Form("stem_bow", (_BOW,), _stem_bow),
        Form("stem_bow_and_swing", (_BOW, _SWING), _stem_bow_and_swing),
        Form("stem_slope", (_SLOPE,), _stem_slope),
        Form("area_slope", (_AREA,), _area_slope),
        Form("area_bow", (_AREA_MID,), _area_bow),
        Form("area_slope_and_bow", (_AREA, replace(_AREA_MID, name="area_mid")), _area_slope_and_bow),
        Form("stem_area", (_AREA,), _stem_area),
    ),
    twins=("lvdt_nonlinearity", "flow_force"),
    absorbs=("compliance", "offset"),
    same_as={
        "bow": ("flow_force",),
        "bow_and_swing": ("flow_force",),
        "stem_bow": ("flow_force",),
        "stem_bow_and_swing": ("flow_force",),
        "stem_slope": ("flow_force",),
    },
)
