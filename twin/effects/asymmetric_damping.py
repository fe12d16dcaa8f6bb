"""Different time constants closing and opening."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from twin.kernels.valve_slots import (
    V_DRAG_CLOSE_S,
    V_DRAG_OPEN_S,
    V_EASES,
    V_EASES_AT,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_SQUARED_S,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_WITHIN,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter


def _parameter(name: str, doc: str) -> Parameter:
    return Parameter(
        name=name,
        kind="fraction",
        lower=-0.9,
        upper=0.9,
        starts=(-0.2, -0.02, 0.02, 0.2),
        scale=0.2,
        doc=doc,
    )


def _two_lags(c: Coefficients, values: Sequence[float]) -> None:
    c.valve[V_TAU_CLOSE_S] *= 1.0 + values[0]
    c.valve[V_TAU_OPEN_S] *= 1.0 - values[0]


def _two_lags_and_rates(c: Coefficients, values: Sequence[float]) -> None:
    # The highest speed follows from the same damping: twice the time constant, half the speed.
    _two_lags(c, values)
    c.valve[V_RATE_CLOSE] /= 1.0 + values[0]
    c.valve[V_RATE_OPEN] /= 1.0 - values[0]


def _one_way(slot: int) -> Callable[[Coefficients, Sequence[float]], None]:
    def write(c: Coefficients, values: Sequence[float]) -> None:
        # What throttles one way, and lets by the other: there the design's time constant is still true.
        c.valve[slot] *= 1.0 + values[0]

    return write


def _throttled_one_way(lag: int, rate: int) -> Callable[[Coefficients, Sequence[float]], None]:
    longer = _one_way(lag)

    def write(c: Coefficients, values: Sequence[float]) -> None:
        # A needle valve beside a check valve: one way fills slowly and is bounded, too.
        longer(c, values)
        c.valve[rate] *= 1.0 - values[1]

    return write


def _lags_and_rates_apart(c: Coefficients, values: Sequence[float]) -> None:
    # What bounds the speed (a vent that chokes, a booster's capacity) need not be what makes the lag.
    _two_lags(c, values)
    c.valve[V_RATE_CLOSE] *= 1.0 - values[1]
    c.valve[V_RATE_OPEN] *= 1.0 + values[1]


def _drag_each_way(c: Coefficients, values: Sequence[float]) -> None:
    # Friction that grows with speed takes pressure; what pulls against a stop has pressure to spare.
    c.valve[V_DRAG_CLOSE_S] += values[0] * c.design.tau_s
    c.valve[V_DRAG_OPEN_S] += values[1] * c.design.tau_s


def _orifice(c: Coefficients, values: Sequence[float]) -> None:
    # Throttled oil or air holds with the square of the speed, and takes pressure likewise.
    c.valve[V_SQUARED_S] += values[0] * c.design.tau_s / c.design.rate_limit
    c.valve[V_SQUARED_S + 1] += values[1] * c.design.tau_s / c.design.rate_limit


def _orifice_alike(c: Coefficients, values: Sequence[float]) -> None:
    _orifice(c, (values[0], values[0]))


def _within(
    orifice: Callable[[Coefficients, Sequence[float]], None],
) -> Callable[[Coefficients, Sequence[float]], None]:
    def write(c: Coefficients, values: Sequence[float]) -> None:
        # Where the actuator has the stops, and the damper sits behind it on the stem.
        orifice(c, values)
        c.valve[V_WITHIN] = 1.0

    return write


def _check_valve(way: int) -> Callable[[Coefficients, Sequence[float]], None]:
    def write(c: Coefficients, values: Sequence[float]) -> None:
        # What opens by the pressure across the damper, which its speed makes, lets by a part of what flows above that.
        c.valve[V_EASES + way] += values[0]
        c.valve[V_EASES_AT] = values[1] * c.design.rate_limit

    return write


def _eases(way: str) -> tuple[Parameter, Parameter]:
    doc = f"how much more a pull adds to the speed {way} where that is higher than `above`, over what it adds below"
    how = replace(_parameter("eases", doc), lower=0.0, upper=9.0, starts=(0.3, 1.5), scale=0.5)
    where = replace(_parameter("above", "that speed over the design's highest"), lower=0.0, upper=0.9)
    return how, replace(where, starts=(0.06, 0.2), scale=0.3, neutral=0.1, size=False)


def _throttled(way: str) -> Parameter:
    how = way.replace("_", " ")
    doc = f"drag with the square of the speed {how}, at the design's highest speed, over that with the speed"
    return replace(_parameter(way, doc), lower=0.0, upper=9.0, starts=(0.1, 1.0), scale=0.5)


def _longer(way: str) -> Parameter:
    doc = f"by how much longer the time constant {way} is, as a share of it; the other way it is the design's"
    return replace(_parameter("longer", doc), upper=4.0, starts=(-0.4, -0.04, 0.04, 0.4, 1.2), scale=0.4)


def _longer_and_slower(way: str) -> tuple[Parameter, Parameter]:
    doc = f"by how much lower the highest speed {way} is, as a share of it; the other way it is the design's"
    return _longer(way), _parameter("slower", doc)


def _drag(way: str) -> Parameter:
    doc = f"what drag adds to the time constant {way}, as a share of it, as long as no stop limits the pull"
    return replace(_parameter(way, doc), starts=(-0.3, -0.03, 0.03, 0.3), scale=0.3)


_ALIKE = "a damping that grows with the speed, the same both ways"

_ASYMMETRY = _parameter(
    "asymmetry", "half the difference of the time constants over their mean, positive = closes slowly"
)
_SPEEDS = _parameter(
    "of_the_speeds", "half the difference of the highest speeds over their mean, positive = closes slowly"
)

EFFECT = Effect(
    name="asymmetric_damping",
    stage="actuator",
    claim="The time constants closing and opening differ.",
    equations="dx/dt = (w - x) / (tau (1 + asymmetry)) closing, (w - x) / (tau (1 - asymmetry)) opening; "
    "closing_alone, opening_alone: tau (1 + longer) that way; "
    "closing_throttled, opening_throttled: rate limit (1 - slower) that way, too; "
    "two_lags_and_rates: rate limit / (1 +- asymmetry), too; two_lags_and_rates_apart: (1 -+ of_the_speeds) of it; "
    "drag_each_way: dx/dt = (clip(w' - tau drag dx/dt) - x) / tau, clip: to the stops, drag its own each way; "
    "orifice_each_way: likewise drag = throttled |dx/dt| / rate limit; "
    "orifice_within_stops: dx/dt = (clip(w') - x) / tau - drag dx/dt; "
    "check_valve: what dx/dt has above a speed, one way, times 1 + eases",
    source="Kayihan, Doyle, Control Eng. Practice 8 (2000) 799; Merritt, Hydraulic Control Systems (Wiley 1967); "
    "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083 (viscous friction)",
    forms=(
        Form("two_lags", (_ASYMMETRY,), _two_lags),
        Form("closing_alone", (_longer("closing"),), _one_way(V_TAU_CLOSE_S)),
        Form("opening_alone", (_longer("opening"),), _one_way(V_TAU_OPEN_S)),
        Form("closing_throttled", _longer_and_slower("closing"), _throttled_one_way(V_TAU_CLOSE_S, V_RATE_CLOSE)),
        Form("opening_throttled", _longer_and_slower("opening"), _throttled_one_way(V_TAU_OPEN_S, V_RATE_OPEN)),
        Form("two_lags_and_rates", (_ASYMMETRY,), _two_lags_and_rates),
        Form("two_lags_and_rates_apart", (_ASYMMETRY, _SPEEDS), _lags_and_rates_apart),
        Form("drag_each_way", (_drag("closing"), _drag("opening")), _drag_each_way),
        Form("orifice_each_way", (_throttled("closing"), _throttled("opening")), _orifice),
        Form("orifice_within_stops", (_throttled("closing"), _throttled("opening")), _within(_orifice)),
        Form("check_valve_closing", _eases("closing"), _check_valve(0)),
        Form("check_valve_opening", _eases("opening"), _check_valve(1)),
        # what holds the stem alike both ways is no asymmetry
        Form("orifice_alike", (_throttled("both_ways"),), _orifice_alike, outside=_ALIKE),
        Form("alike_within_stops", (_throttled("both_ways"),), _within(_orifice_alike), outside=_ALIKE),
    ),
    absorbs=("tau",),
)
