"""Friction sits inside the force balance: the stem stops when the pressure reverses, instead of coasting on."""

from __future__ import annotations

from collections.abc import Sequence

from twin.kernels.slots import FOREVER
from twin.kernels.valve_slots import (
    V_GIVE_HIGH,
    V_GIVE_LOW,
    V_HARD_HIGH,
    V_HARD_LOW,
    V_HIGH,
    V_IN_MOTION,
    V_KEPT,
    V_LOW,
    V_OUTER,
    V_OUTER_CENTRE,
    V_OUTER_SLOPE,
    V_PRESLIDING,
    V_ROUNDED,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter

_SHARE = Parameter(
    name="share",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.02, 0.1, 0.35, 0.7),
    scale=0.3,
    doc="share of the half deadband that is friction in the force balance; the rest is play before it",
)


_PRESLIDING = Parameter(
    name="presliding",
    kind="position",
    lower=0.0,
    upper=0.25,
    starts=(0.003, 0.02),
    scale=0.04,
    doc="distance after a reversal over which all of the friction has turned",
    size=False,
)


_SPEED = Parameter(
    name="speed",
    kind="position_rate",
    lower=0.0,
    upper=0.2,
    starts=(0.0015, 0.01),
    scale=0.02,
    doc="speed at which most of the friction has turned",
    size=False,
)


_LOAD = Parameter(
    name="load",
    kind="fraction",
    lower=0.0,
    upper=1.0,
    starts=(0.01, 0.1),
    scale=0.15,
    doc="by how much friction is more at full pressure than at least pressure, over the half deadband",
    size=False,
)


def _beyond(where: str) -> Parameter:
    return Parameter(
        name=f"beyond_{where}",
        kind="position",
        lower=0.0,
        upper=0.1,
        starts=(0.005,),
        scale=0.01,
        doc=f"how far beyond the {where} stop forces would balance at most, that is how soft the stop is",
        size=False,
    )


def _gives(where: str) -> Parameter:
    return Parameter(
        name=f"gives_{where}",
        kind="fraction",
        lower=0.0,
        upper=1.0,
        starts=(0.05,),
        scale=0.1,
        doc=f"of what pulls the stem beyond the {where} stop, the share that still moves it there",
        size=False,
    )


def _full(c: Coefficients, _values: Sequence[float]) -> None:
    c.valve[V_IN_MOTION] = 1.0


def _partial(c: Coefficients, values: Sequence[float]) -> None:
    if values[0] <= 0.0:
        return
    d = c.design
    c.valve[V_IN_MOTION] = 1.0
    c.valve[V_OUTER] = 0.5 * d.deadband * (1.0 - values[0])
    c.valve[V_OUTER_CENTRE] = d.offset
    c.valve[V_OUTER_SLOPE] = 1.0 / d.compliance


def _short(c: Coefficients, values: Sequence[float]) -> None:
    """The stops hold the play before the friction, so that the stem rests short of them, too."""
    half = 0.5 * c.design.deadband * values[0]
    c.widen(-half)
    c.valve[V_KEPT] = half * c.design.compliance


def _rounded(c: Coefficients, values: Sequence[float]) -> None:
    _partial(c, values)
    if values[0] > 0.0:
        c.valve[V_ROUNDED] = values[1]


def _met_at_speed(c: Coefficients) -> None:
    """Only the stem is held by the stops: forces may balance beyond them, and the stem meets them at speed."""
    c.valve[V_HARD_LOW], c.valve[V_LOW] = max(c.valve[V_HARD_LOW], c.valve[V_LOW]), -FOREVER
    c.valve[V_HARD_HIGH], c.valve[V_HIGH] = min(c.valve[V_HARD_HIGH], c.valve[V_HIGH]), FOREVER


def _elastic(c: Coefficients, values: Sequence[float]) -> None:
    _full(c, values)
    c.valve[V_PRESLIDING] += values[0]  # what changed since may stand before it
    c.press_beyond_stops(*values[1:])


def _landing(c: Coefficients, values: Sequence[float]) -> None:
    """A speed control that closes towards the stop ahead: beyond the stop, a share of the pull is left."""
    presliding, below, above = values
    _elastic(c, (presliding, below * c.design.travel, above * c.design.travel))
    c.valve[V_GIVE_LOW], c.valve[V_GIVE_HIGH] = below, above


def _loaded(c: Coefficients, values: Sequence[float]) -> None:
    share, load, below, above = values
    _partial(c, values)
    if share > 0.0:
        load = min(load, 2.0 * share)  # there is no friction that drives
        more = 0.5 * c.design.deadband * load * (c.xi - 0.5)
        c.close_shift += more
        c.open_shift -= more
        c.press_beyond_stops(below, above)


def _partly_elastic(c: Coefficients, values: Sequence[float]) -> None:
    share, presliding, below, above = values
    _partial(c, values)
    if share > 0.0:
        c.valve[V_PRESLIDING] += presliding
        c.press_beyond_stops(below, above)


def _full_hit(c: Coefficients, values: Sequence[float]) -> None:
    _full(c, values)
    _met_at_speed(c)


def _partial_hit(c: Coefficients, values: Sequence[float]) -> None:
    _partial(c, values)
    if values[0] > 0.0:
        _met_at_speed(c)


EFFECT = Effect(
    name="friction_in_motion",
    stage="actuator",
    claim="The stem stops when the pressure reverses instead of coasting to its play target.",
    equations="w = max(k (p - a1), min(k (p - a2), x)); partial: a play of (1 - share) (a1 - a2) comes before; "
    "short_of_target: that play is held inside the stops, what pulls the stem is |w - x| less k share (a1 - a2) / 2; "
    "rounded: tau v + share k (a1 - a2) / 2 tanh(v / speed) = k (p - (a1 + a2) / 2) - x behind that play; elastic: "
    "friction turns over a distance, w is held only beyond the stops, x at the stops; elastic_landing: beyond a stop "
    "that the stem lands on softly w goes on by gives times what it would; "
    "partial_elastic: as partial, with such friction and such stops; "
    "partial_loaded: as partial, with friction in proportion to share + load (w / travel - 1/2), load up to 2 share, "
    "and such stops",
    source="Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100; Kayihan, Doyle, Control Eng. Practice 8 (2000) 799; "
    "Andersson, Soderberg, Bjorklund, Tribology International 40 (2007) 580 (rounded)",
    forms=(
        Form("full", (), _full),
        Form("partial", (_SHARE,), _partial),
        Form("short_of_target", (_SHARE,), _short),
        Form("elastic", (_PRESLIDING, _beyond("lower"), _beyond("upper")), _elastic, described=True),
        Form("elastic_landing", (_PRESLIDING, _gives("lower"), _gives("upper")), _landing, described=True),
        Form("rounded", (_SHARE, _SPEED), _rounded),
        Form("full_hit", (), _full_hit),
        Form("partial_hit", (_SHARE,), _partial_hit),
        Form("partial_elastic", (_SHARE, _PRESLIDING, _beyond("lower"), _beyond("upper")), _partly_elastic),
        Form("partial_loaded", (_SHARE, _LOAD, _beyond("lower"), _beyond("upper")), _loaded),
    ),
    absorbs=("tau",),
)
