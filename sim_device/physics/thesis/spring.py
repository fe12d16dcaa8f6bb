"""The spring and the diaphragm: how far a pressure above the friction moves the plate."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PHASE, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled

IMPERFECTIONS = (
    Imperfection(
        "spring_asymmetry",
        "actuator",
        "1",
        (0.012, 0.035, 0.12),
        "Compliance is (1 + size/2) k closing and (1 - size/2) k opening, about the curves' feet or mid-travel.",
        forms=("foot", "pivot"),
        scales=(1.0, 1.85),
        limit=0.8,
        signed=True,
    ),
    Imperfection(
        "nonlinear_spring",
        "actuator",
        "1",
        (0.004, 0.0125, 0.04),
        "The stroke departs from the straight line by up to `size` of travel: a bulge, an S, or the loss of effective "
        "diaphragm area over the stroke.",
        forms=("bulge", "s", "area"),
        scales=(1.0, 1.2, 0.4),
        limit=0.3,
        signed=True,
    ),
    Imperfection(
        "flow_force",
        "actuator",
        "psi",
        (0.014, 0.044, 0.16),
        "Fluid pushes the plug open with up to `size`: in proportion to the opening, or mostly near the seat.",
        forms=("linear", "seat"),
        limit=4.0,
        signed=True,
    ),
    Imperfection(
        "reduced_travel",
        "actuator",
        "in",
        (0.0025, 0.0075, 0.025),
        "The closed stop (or the open one) stands `size` inside the design travel.",
        forms=("closed", "open"),
        limit=0.4,
    ),
    Imperfection(
        "thermal_spring",
        "actuator",
        "1",
        (0.009, 0.028, 0.1),
        "The spring rate breathes by `size` with the room's heating, every 140 s.",
        limit=0.5,
        outsider=True,
    ),
    Imperfection(
        "snap_region",
        "actuator",
        "psi",
        (0.45, 0.7, 1.1),
        "A buckled diaphragm: around mid-travel the spring force falls by `size`, so the stem snaps through.",
        limit=3.0,
        outsider=True,
    ),
    Imperfection(
        "diaphragm_hole",
        "actuator",
        "psi",
        (0.022, 0.068, 0.24),
        "A tear in the diaphragm flaps every 9 s: open, it loses up to `size` of the pressure, most when stretched.",
        limit=4.0,
        outsider=True,
    ),
)

_HEATING_PERIOD_S = 140.0
_FLAP_S = 9.0


@compiled
def stroke(q: Any, s: Any, excess: float, closing: bool) -> float:
    """Where the plate rests when the pressure exceeds spring preload and friction by `excess` [psi]; in."""
    k = q.compliance
    if q.thermal_spring > 0.0:
        k *= 1.0 + q.thermal_spring * math.sin(2.0 * math.pi * (s.time / _HEATING_PERIOD_S + uniform(s.seed, PHASE, 2)))
    turn = 1.0 + (0.5 if closing else -0.5) * q.spring_asymmetry
    if q.spring_asymmetry_form == 0 or q.spring_asymmetry == 0.0:
        x = k * turn * excess
    else:
        x = 0.5 * q.travel + k * turn * (excess - 0.5 * q.travel / q.compliance)
    if q.nonlinear_spring != 0.0:
        z = min(max(x / q.travel, 0.0), 1.0)
        if q.nonlinear_spring_form == 0:
            x += q.nonlinear_spring * q.travel * 4.0 * z * (1.0 - z)
        elif q.nonlinear_spring_form == 1:
            x += q.nonlinear_spring * q.travel * math.sin(2.0 * math.pi * z)
    return float(x)


@compiled
def push(q: Any, s: Any, p: float, w: float) -> float:
    """Pressure that is lost to forces which depend on the stroke `w` [psi]; positive opens the valve."""
    share = w / q.travel
    opening = 1.0 - share
    total = 0.0
    if q.flow_force_form == 0:
        total += q.flow_force * opening
    else:
        total += q.flow_force * 4.0 * share * share * opening * 1.6875
    if q.nonlinear_spring_form == 2:
        total += 4.0 * q.nonlinear_spring * p * share * 0.25
    total -= q.snap_region / (1.0 + math.exp(-(share - 0.5) / 0.03))
    if s.time % _FLAP_S < 0.5 * _FLAP_S:
        total += q.diaphragm_hole * share
    return float(total)


@compiled
def stops(q: Any) -> tuple[float, float]:
    """The open and the closed end stop [in]."""
    if q.reduced_travel_form == 0:
        return 0.0, q.travel - q.reduced_travel
    return float(q.reduced_travel), float(q.travel)
