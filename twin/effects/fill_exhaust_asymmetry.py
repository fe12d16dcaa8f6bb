"""Pressure rises and falls with different time constants: filling and exhausting pass different restrictions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from twin.kernels.ep_slots import (
    EP_CHAMBER,
    EP_CLOG_DOWN,
    EP_CLOG_UP,
    EP_CRACK,
    EP_PORT_DOWN,
    EP_PORT_UP,
    EP_QUICK,
    EP_TAU_FALL_S,
    EP_TAU_RISE_S,
    EP_WANES,
    EP_WANES_BELOW,
)
from twin.model.coefficients import Coefficients
from twin.model.effect import Effect, Form, Parameter


def _apply(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_TAU_RISE_S] *= 1.0 + values[0]
    c.ep[EP_TAU_FALL_S] *= 1.0 - values[0]


def _port(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[EP_PORT_UP] *= 1.0 + max(-values[0], 0.0)
    c.ep[EP_PORT_DOWN] *= 1.0 + max(values[0], 0.0)


def _port_and_chamber(c: Coefficients, values: Sequence[float]) -> None:
    dirt, room, clean = values
    _port(c, (dirt,))
    c.ep[EP_PORT_UP if dirt > 0.0 else EP_PORT_DOWN] = 1.0 + clean * abs(dirt)
    c.ep[EP_CHAMBER] = 1.0 + room if dirt != 0.0 else 0.0


def _quick(c: Coefficients, values: Sequence[float]) -> None:
    c.ep[[EP_QUICK, EP_CRACK]] = values


def _clogged(c: Coefficients, values: Sequence[float]) -> None:
    # A silencer full of dirt, or a screen, is turbulent: its pressure drop grows with the square of the flow.
    c.ep[EP_CLOG_UP] += max(-values[0], 0.0) * c.design.ep_tau_s
    c.ep[EP_CLOG_DOWN] += max(values[0], 0.0) * c.design.ep_tau_s


def _waning(c: Coefficients, values: Sequence[float]) -> None:
    # What exhausts is driven by its own pressure above the atmosphere's, which wanes; what fills, by the supply.
    d = c.design
    shut = d.a1 + d.travel / d.compliance
    c.ep[EP_WANES] = values[0] / (shut - d.a2)
    c.ep[EP_WANES_BELOW] = d.a2 + values[1] * (shut - d.a2)


_CLOG = Parameter(
    name="clog",
    kind="time_per_pressure",
    lower=-6.0,
    upper=6.0,
    starts=(-0.8, -0.1, 0.1, 0.8),
    scale=0.3,
    doc="by what share the lag of the exhaust grows for each unit of the slope; negative: that of the supply",
)
_DIRT = Parameter(
    name="dirt",
    kind="fraction",
    lower=-12.0,
    upper=12.0,
    starts=(-2.0, -0.3, 0.3, 2.0),
    scale=1.0,
    doc="the exhaust lets 1 / (1 + dirt) of the flow through; negative: the supply",
)
#: Of a port that never limited anything there may be much before it shows.
_MUCH_DIRT = replace(_DIRT, lower=-60.0, upper=60.0, starts=(-12.0, -3.0, 3.0, 12.0), scale=3.0)
_ROOM = Parameter(
    name="room",
    kind="fraction",
    lower=-0.95,
    upper=3.0,
    starts=(-0.5, 0.2),
    scale=0.5,
    doc="by how much more the stem sweeps than a machine whose ports never limited it had shown",
    size=False,
)
#: More of it, and one limit would hold both ports.
_CLEAN = Parameter(
    name="clean",
    kind="fraction",
    lower=-0.1,
    upper=0.2,
    starts=(0.05,),
    scale=0.05,
    doc="by how much less the other port lets through than such a machine had shown, as a share of the dirt",
    size=False,
)
_QUICK = Parameter(
    name="quick",
    kind="fraction",
    lower=0.0,
    upper=30.0,
    starts=(0.3, 1.5),
    scale=1.0,
    doc="further flow of a quick exhaust for each unit of the error beyond its edge, over that of the port",
)
_CRACK = Parameter(
    name="crack",
    kind="pressure",
    lower=0.0,
    upper=4.0,
    starts=(0.05, 0.3),
    scale=0.3,
    doc="how far the pressure is above its goal where the quick exhaust begins to open",
    size=False,
)
_WANES = Parameter(
    name="wanes",
    kind="fraction",
    lower=0.0,
    upper=12.0,
    starts=(0.2, 1.0),
    scale=0.5,
    doc="by what share the lag of a falling pressure grows from where the valve is shut to where it is open",
)
_BELOW = Parameter(
    name="below",
    kind="fraction",
    lower=0.1,
    upper=1.5,
    starts=(0.5, 0.9),
    scale=0.5,
    doc="from which pressure on, as a share of the way from where the valve is open to where it is shut",
    neutral=0.9,
    size=False,
)

EFFECT = Effect(
    name="fill_exhaust_asymmetry",
    stage="ep",
    claim="Pressure rises and falls with different time constants.",
    equations="dp/dt = (u - p) / (tau (1 + asymmetry)) rising, (u - p) / (tau (1 - asymmetry)) falling; "
    "port: tau (1 + dirt) falling, or tau (1 - dirt) rising where it is negative; of a booster, the flow instead; "
    "port_and_chamber: likewise, the other port lets 1 / (1 + clean |dirt|) through, "
    "air of the booster times 1 + room, as seen with the stem in the middle, filling as from its supply (ISO 6358); "
    "quick_exhaust: tau dp/dt = u - p, and - quick (p - u - crack) where that opens; "
    "clogged: tau (1 + clog |dp/dt|) dp/dt = u - p falling, or rising where it is negative; "
    "waning: tau (1 + wanes (b - p) / (shut - open)) falling below b = open + below (shut - open), where open = a2 and "
    "shut = a1 + travel / k",
    source="Richer, Hurmuzlu, J. Dyn. Syst. Meas. Control 122 (2000) 416 (filling and exhausting through orifices)",
    forms=(
        Form(
            "two_lags",
            (
                # Parameterised about the mean of the two, so that re-tuning the converter lag cannot imitate it.
                Parameter(
                    name="asymmetry",
                    kind="fraction",
                    lower=-0.95,
                    upper=0.95,
                    starts=(-0.4, -0.05, 0.05, 0.4),
                    scale=0.3,
                    doc="half the difference of the two time constants over their mean, positive = rises more slowly",
                ),
            ),
            _apply,
        ),
        Form(
            "port",
            (_DIRT,),
            _port,
            by_pressure=True,
        ),
        Form("port_and_chamber", (_MUCH_DIRT, _ROOM, _CLEAN), _port_and_chamber, by_pressure=True),
        Form("quick_exhaust", (_QUICK, _CRACK), _quick),
        Form("clogged", (_CLOG,), _clogged),
        Form("waning", (_WANES, _BELOW), _waning),
    ),
    twins=("ep_rate_limit",),
    absorbs=("ep_tau",),
)
