"""Play between the stem and the LVDT core."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from twin.kernels.sensor_slots import (
    LESS,
    S_LESS,
    S_PLAY,
    S_SHARE,
    S_SINKS_S,
    S_SLIPS,
    S_SLIPS_ABOVE,
    S_SLIPS_OPEN,
    S_SOONER,
    S_ZERO,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

_PLAY = Parameter(
    name="play",
    kind="position",
    lower=0.0,
    upper=0.15,
    starts=(0.002, 0.006, 0.02),
    scale=0.01,
    doc="full width of the lost motion",
)
_ONE_SIDED = replace(
    _PLAY,
    lower=-0.15,
    starts=(-0.02, -0.006, -0.002, 0.002, 0.006, 0.02),
    doc="full width; positive where the zero was set with the core at the far side, negative at the near side",
)


_SINKS = Parameter(
    name="sinks",
    kind="time",
    lower=0.3,
    upper=300.0,
    starts=(4.0, 20.0),
    scale=10.0,
    doc="time in which a weight or a weak spring takes up the slack",
    neutral=20.0,
    size=False,
)


_LOST = Parameter(
    name="lost",
    kind="fraction",
    lower=0.0,
    upper=0.5,
    starts=(0.02, 0.1),
    scale=0.1,
    doc="share of the way of a quick stem that the coupling loses when closing",
)
_LOST_OPEN = replace(_LOST, name="lost_open", doc="the same when opening")
_ABOVE = Parameter(
    name="above",
    kind="fraction",
    lower=0.02,
    upper=0.95,
    starts=(0.1, 0.25, 0.4, 0.55, 0.7),
    scale=0.4,
    doc="from which speed on, as a share of the rate limit",
    neutral=0.4,
    size=False,
)


_SOONER = Parameter(
    name="sooner",
    kind="fraction",
    lower=0.02,
    upper=0.95,
    starts=(0.2, 0.5),
    scale=0.3,
    doc="share of the width behind which half of the pull is there",
    neutral=0.5,
    size=False,
)


#: Of the play, from which on a sleeve pulls that has none.
_NONE = 1e-6
_SHARE = replace(
    _SOONER,
    name="share",
    upper=0.9,
    starts=(0.2, 0.4),
    doc="share of the stem's way that a sleeve in the play passes on at once",
    neutral=0.3,
)


_WORN = tuple(
    replace(_PLAY, name=name, starts=starts, doc=f"full width with the stem {where}")
    for name, where, starts in (
        ("open", "fully open", (0.002, 0.02)),
        ("below_middle", "a third closed", (0.006,)),
        ("above_middle", "two thirds closed", (0.006,)),
        ("closed", "closed", (0.02, 0.002)),
    )
)


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_PLAY] = values[0]


def _one_sided(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[S_PLAY] = abs(values[0])
    c.sensor[S_ZERO] += 0.5 * values[0]


def _sinks(c: Coefficients, values: Sequence[float]) -> None:
    _apply(c, values)
    c.sensor[S_SINKS_S] = values[1]


def _sinks_back(c: Coefficients, values: Sequence[float]) -> None:
    _apply(c, values)
    c.sensor[S_SINKS_S] = -values[1]


def _worn(c: Coefficients, values: Sequence[float]) -> None:
    widest = max(values)
    c.sensor[S_PLAY] = widest
    c.sensor[S_LESS : S_LESS + LESS] = widest - np.asarray(values)


def _soft(c: Coefficients, values: Sequence[float]) -> None:
    _apply(c, values)
    c.sensor[S_SOONER] = values[1]


def _sleeve(c: Coefficients, values: Sequence[float]) -> None:
    _apply(c, values)
    c.sensor[[S_SOONER, S_SHARE]] = _NONE, values[1] - 0.5


def _slips(c: Coefficients, values: Sequence[float]) -> None:
    c.sensor[[S_SLIPS, S_SLIPS_OPEN]] = values[:2]
    c.sensor[S_SLIPS_ABOVE] = values[2] * c.design.rate_limit


EFFECT = Effect(
    name="linkage_lost_motion",
    stage="sensor",
    claim="There is play between the stem and the LVDT core.",
    equations="y = max(x - play/2, min(x + play/2, y)); one_sided: y + play/2, as the zero was set on one side; sinks: "
    "within the play dy/dt = (x + play/2 - y) / sinks, sinks_back: (x - play/2 - y) / sinks; worn: play goes by x, "
    "straight between thirds of the travel; soft: the mean of that and of the same with sooner play; sleeve: share of "
    "x, and the rest of that; a coupling that slips has no play, only told from what it resembles: dy = (1 - lost) dx "
    "above a speed",
    source="Nordin, Gutman, Automatica 38 (2002) 1633; Tao, Kokotovic, Adaptive Control of Systems with Actuator and "
    "Sensor Nonlinearities (Wiley 1996)",
    forms=(
        Form("play", (_PLAY,), _apply),
        Form("one_sided", (_ONE_SIDED,), _one_sided),
        Form("sinks", (_PLAY, _SINKS), _sinks),
        Form("sinks_back", (_PLAY, _SINKS), _sinks_back),
        Form("worn", _WORN, _worn),
        Form("soft", (_PLAY, _SOONER), _soft),
        Form("sleeve", (_PLAY, _SHARE), _sleeve),
        Form(
            "slips",
            (_LOST, _LOST_OPEN, _ABOVE),
            _slips,
            outside="a coupling between stem and gauge slips in quick moves",
        ),
    ),
    twins=("friction_in_motion",),
    absorbs=("deadband",),
)
