"""Compliance depends on position: the spring stiffens or the effective diaphragm area changes over the stroke."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import FloatArray
from twin.kernels.valve_slots import V_BREAKS, V_BREAKS_S, V_HALF, V_MIDDLE, V_STIFFENS
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter
from twin.model.shapes import CENTRE, WHEN, WIDTH, bow, edge, swing


def _parameter(name: str, doc: str) -> Parameter:
    return Parameter(name=name, kind="pressure", lower=-1.5, upper=1.5, starts=(-0.25, 0.25), scale=0.25, doc=doc)


def _bow(c: Coefficients, values: Sequence[float]) -> None:
    c.shift(values[0] * bow(c.xi))


def _bow_and_swing(c: Coefficients, values: Sequence[float]) -> None:
    _bow(c, values)
    c.shift(values[1] * swing(c.xi))


def _stem_bow(c: Coefficients, values: Sequence[float]) -> None:
    shift = values[0] * bow(c.xi)
    c.bend_at_stem(shift, shift)


def _stem_bow_and_swing(c: Coefficients, values: Sequence[float]) -> None:
    _stem_bow(c, values)
    c.bend_at_stem(*[values[1] * swing(c.xi)] * 2)


def _stem_slope(c: Coefficients, values: Sequence[float]) -> None:
    nothing = np.zeros_like(c.xi)
    c.bend_at_stem(nothing, nothing, 1.0 + values[0] * (c.xi - 0.5))


def _area(c: Coefficients, share: FloatArray) -> None:
    """Where the diaphragm's area is larger by `share`, every pressure pulls more: spring and friction alike."""
    spring = c.xi * _span(c)
    c.close_shift += (c.design.a1 + spring) * (1.0 / (1.0 + share) - 1.0)
    c.open_shift += (c.design.a2 + spring) * (1.0 / (1.0 + share) - 1.0)


def _area_slope(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * (c.xi - 0.5))


def _area_kept(c: Coefficients, values: Sequence[float]) -> None:
    # The spring makes up for it over the whole stroke: the middle of the curves is the design's at both ends.
    _area(c, values[0] * c.xi)
    c.shift(values[0] * c.xi * (c.design.offset + _span(c)) / (1.0 + values[0] * c.xi))


def _area_bow(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * bow(c.xi))


def _area_slope_and_bow(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * (c.xi - 0.5) + values[1] * bow(c.xi))


def _stem_area(c: Coefficients, values: Sequence[float]) -> None:
    # k (p (1 + share) - a - x / k) is (1 + share) k (p - a / (1 + share)) - x
    larger = 1.0 + values[0] * (c.xi - 0.5)
    c.bend_at_stem(c.design.a1 * (1.0 / larger - 1.0), c.design.a2 * (1.0 / larger - 1.0), larger)


#: How much steeper than the spring a fall is at least that is called a fold.
_LEAST_FOLD = 1.1


def _step(c: Coefficients, values: Sequence[float]) -> None:
    c.shift(values[0] * _span(c) * values[2] * edge(c.xi, values[1], values[2]))


def _hardens(c: Coefficients, values: Sequence[float]) -> None:
    c.shift(0.5 * values[0] * _span(c) * np.square(c.xi))


def _helper(c: Coefficients, values: Sequence[float]) -> None:
    c.shift(values[0] * _span(c) * np.maximum(c.xi - values[1], 0.0))


def _area_step(c: Coefficients, values: Sequence[float]) -> None:
    _area(c, values[0] * (edge(c.xi, values[1], values[2]) - 0.5))


def _span(c: Coefficients) -> float:
    return c.design.travel / c.design.compliance


def _drop(c: Coefficients, values: Sequence[float]) -> FloatArray:
    # Steeper than the spring, so that the force falls on the way and the stem snaps through.
    width = values[0] / ((_LEAST_FOLD + values[2]) * _span(c))
    return -values[0] * edge(c.xi, values[1], width)


def _snaps(c: Coefficients, values: Sequence[float]) -> None:
    c.shift(_drop(c, values))


def _stem_snaps(c: Coefficients, values: Sequence[float]) -> None:
    shift = _drop(c, values)
    c.bend_at_stem(shift, shift)


def _breaks(c: Coefficients, values: Sequence[float]) -> None:
    before_s, all_s = c.course_s
    c.valve[[V_BREAKS, V_STIFFENS]] = values[:2]
    c.valve[V_BREAKS_S] = max(values[2] * all_s - before_s, 0.0)
    c.valve[[V_MIDDLE, V_HALF]] = c.design.offset, 0.5 * (c.design.a1 - c.design.a2)


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

_CENTRE = replace(CENTRE, lower=0.02, upper=0.98, starts=(0.25, 0.5, 0.75))
_WIDTH = replace(WIDTH, upper=0.4, starts=(0.1,), scale=0.1, doc="length of the change, fraction of travel")
_STIFFER = Parameter(
    name="stiffer",
    kind="fraction",
    lower=-0.95,
    upper=8.0,
    starts=(-0.5, 0.5, 2.0),
    scale=0.5,
    doc="excess of the spring's rate within the length of the change",
)
_HELPS = replace(
    _STIFFER,
    lower=-0.8,
    upper=2.3,  # what is stiffer is a stop (reduced_travel)
    starts=(-0.2, 0.2),
    scale=0.3,
    doc="excess of the spring's rate from there to the closed end, where a second spring takes part",
)
_HARDER = replace(
    _HELPS,
    name="harder",
    lower=-0.9,
    doc="excess of the spring's rate at the closed end, growing evenly from fully open",
)
_FROM = replace(
    _CENTRE, name="from", lower=0.05, upper=0.95, starts=(0.3, 0.55, 0.8), doc="where it begins, fraction of travel"
)
_DROP = Parameter(
    name="drop",
    kind="pressure",
    lower=0.0,
    upper=2.5,
    starts=(0.25, 0.9),
    scale=0.5,
    doc="pressure by which the spring gives way",
    smooth=False,
    looks=6,
)
_STEEPER = Parameter(
    name="steeper",
    kind="fraction",
    lower=0.0,
    upper=11.0,
    starts=(0.1, 0.6, 1.4, 4.0),
    scale=2.0,
    doc="by how much faster than 1.1 times the spring's rate it gives way at the centre",
    size=False,
    smooth=False,
)
#: A jump that is looked for at another place, or a little less long, than it is may be no help at all.
_SNAPS_AT = replace(_CENTRE, lower=0.0, starts=tuple(k / 20 for k in range(2, 19)), neutral=0.0, smooth=False)
_TAKES = replace(_parameter("takes", "by how much more pressure it takes from then on"), lower=-4.0, upper=4.0)
_RATE = replace(_STIFFER, name="rate", upper=1.5, starts=(0.0,), doc="excess of its rate from then on", size=False)
#: A spring that is right at both ends and not between, at the stem itself: mostly it is the fluid that pushes there.
_OTHERS = 0.01
_SNAPS = "the spring gives way at a place, and the stem snaps through"

EFFECT = Effect(
    name="nonlinear_spring",
    stage="actuator",
    claim="Compliance depends on position.",
    equations="closing p = a1 + w/k + s(w), opening p = a2 + w/k + s(w), s = bow * 4 xi (1 - xi) + swing * S(xi); "
    "stem_*: s of the stem x; stem_slope: k (1 + slope (x/travel - 1/2)); "
    "area_*: p (1 + area (xi - 1/2) + area_mid 4 xi (1 - xi)) in place of p, xi = w/travel; stem_area: x/travel; "
    "area_kept: p (1 + area xi), s = area xi ((a1 + a2)/2 + travel/k); area_step: p (1 + larger (E - 1/2)); "
    "step: s = stiffer travel/k width E, E = (1 + tanh(2 (xi - centre) / width)) / 2; "
    "hardens: s = harder travel/k xi^2 / 2; helper: s = stiffer travel/k max(xi - from, 0); "
    "only told from it: snaps, stem_snaps: s = -drop E, steeper at the centre than the spring; "
    "breaks: from a time on p = (a1 + a2)/2 + takes +- (a1 - a2)/2 + (1 + rate) w/k",
    source="actuator data sheets (effective area over stroke; spring ranges such as 3 to 15 psi)",
    forms=(
        Form("bow", (_BOW,), _bow),
        Form("bow_and_swing", (_BOW, _SWING), _bow_and_swing),
        Form("stem_bow", (_BOW,), _stem_bow, odds=_OTHERS),
        Form("stem_bow_and_swing", (_BOW, _SWING), _stem_bow_and_swing, odds=_OTHERS),
        Form("stem_slope", (_SLOPE,), _stem_slope),
        Form("area_slope", (_AREA,), _area_slope),
        Form("area_kept", (_AREA,), _area_kept),
        Form("area_bow", (_AREA_MID,), _area_bow),
        Form("area_slope_and_bow", (_AREA, replace(_AREA_MID, name="area_mid")), _area_slope_and_bow),
        Form("stem_area", (_AREA,), _stem_area),
        Form("step", (_STIFFER, _CENTRE, _WIDTH), _step),
        Form("hardens", (_HARDER,), _hardens),
        Form("helper", (_HELPS, _FROM), _helper),
        Form("area_step", (replace(_AREA, name="larger"), _CENTRE, _WIDTH), _area_step),
        Form("snaps", (_DROP, _SNAPS_AT, _STEEPER), _snaps, outside=_SNAPS),
        Form("stem_snaps", (_DROP, _SNAPS_AT, _STEEPER), _stem_snaps, outside=_SNAPS),
        Form("breaks", (_TAKES, _RATE, WHEN), _breaks, outside="the spring changes all at once"),
    ),
    twins=("lvdt_nonlinearity", "flow_force"),
    absorbs=("compliance", "offset"),
    same_as={
        "bow": ("flow_force",),
        "bow_and_swing": ("flow_force",),
        "stem_bow": ("flow_force",),
        "stem_bow_and_swing": ("flow_force",),
        "stem_slope": ("flow_force",),
        "hardens": ("flow_force",),
    },
)
