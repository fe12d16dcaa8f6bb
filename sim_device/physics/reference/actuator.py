"""The actuator: tube, diaphragm chamber with moving volume, spring, stops and the balance of forces on the stem."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PHASE, TELEGRAPH, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled
from sim_device.physics.reference.air import flow
from sim_device.physics.reference.packing import bristles, settle_bristles, soft_rings
from sim_device.physics.reference.record import AREA, ATMOSPHERE, GAS, INCH, PSI

IMPERFECTIONS = (
    Imperfection(
        "nonlinear_spring",
        "actuator",
        "1",
        (0.017, 0.05, 0.17),
        "A progressive spring: its rate is `size` times lower at the open end and higher at the closed end.",
        limit=0.9,
        signed=True,
    ),
    Imperfection(
        "asymmetric_damping",
        "actuator",
        "1",
        (0.07, 0.23, 1.5),
        "The check valve of the hydraulic damper leaks: opening meets 1/(1 + size) of its drag.",
        limit=20.0,
    ),
    Imperfection(
        "creep",
        "actuator",
        "1",
        (0.02, 0.06, 0.2),
        "Rubber in the diaphragm carries `size` of the spring rate at first and lets go with 10 s and 70 s.",
        limit=2.0,
    ),
    Imperfection(
        "reduced_travel",
        "actuator",
        "in",
        (0.0026, 0.0078, 0.025),
        "The closed stop (or the open one) stands `size` inside the travel.",
        forms=("closed", "open"),
        limit=0.4,
    ),
    Imperfection(
        "additional_lag",
        "actuator",
        "s",
        (0.065, 0.2, 0.73),
        "A worn elastic coupling: the plug, with a drag of its own, follows the stem with `size`.",
        limit=10.0,
    ),
    Imperfection(
        "flow_force",
        "actuator",
        "psi",
        (0.36, 1.1, 3.5),
        "Oil with a pressure drop of `size` across a plug of 1.5 in2 pushes it open, most at half opening.",
        limit=100.0,
        signed=True,
    ),
    Imperfection(
        "thermal_spring",
        "actuator",
        "1",
        (0.007, 0.021, 0.075),
        "The hot valve body heats the spring and its rate breathes by `size` every 170 s.",
        limit=0.5,
        outsider=True,
    ),
    Imperfection(
        "diaphragm_hole",
        "actuator",
        "mm2",
        (0.22, 0.7, 2.4),
        "A tear in the diaphragm flaps every 11 s: open, it leaks through up to `size`, most when stretched.",
        limit=5.0,
        outsider=True,
    ),
    Imperfection(
        "snap_region",
        "actuator",
        "psi",
        (0.45, 0.7, 1.1),
        "A buckled spring seat gives way by `size` around mid-travel, faster than the spring stiffens.",
        limit=3.0,
        outsider=True,
    ),
    Imperfection(
        "water_slug",
        "actuator",
        "1",
        (2.6, 7.0, 21.0),
        "Water in the tubing cuts its conductance to 1/(1 + size) for 7 s, in one of three spells of 14 s.",
        limit=1.0e4,
        outsider=True,
    ),
)

_RELAX_S = (10.0, 70.0)
_HEATING_S = 170.0
_FLAP_S = 11.0
_SHUT_M_S = 2.0e-5  # what the damper still lets through with its pin fully in
_PLUG_M2 = 1.5 * INCH * INCH


@compiled
def _tube(q: Any, s: Any) -> float:
    """Mass flow from the line into the chamber [kg/s]."""
    conductance = q.tube
    if q.water_slug > 0.0:
        window = int(s.time / 14.0)
        if uniform(s.seed, TELEGRAPH, 1000 + window) < 0.33 and s.time - 14.0 * window < 7.0:
            conductance /= 1.0 + q.water_slug
    return flow(conductance, q.tube_b, q.tube_laminar, s.line + ATMOSPHERE, s.chamber + ATMOSPHERE)


@compiled
def _hole(q: Any, s: Any) -> float:
    """Mass flow through the torn diaphragm to the room [kg/s]."""
    share = min(max(s.x / q.travel, 0.0), 1.0) if s.time % _FLAP_S < 0.5 * _FLAP_S else 0.0
    # Gidlund's rule for the sonic conductance of an orifice of diameter d: C = 0.128 d^2 l/(s bar), d in mm
    conductance = 0.128 * 4.0 / math.pi * q.diaphragm_hole * share * 1.0e-8
    return flow(conductance, 0.4, 0.999, s.chamber + ATMOSPHERE, ATMOSPHERE)


@compiled
def fill(q: Any, s: Any, booster: float, booster_slope: float, h: float) -> None:
    """Advances line and chamber by `h` seconds, given the booster's flow and its slope."""
    stiffness = q.polytropic * GAS
    into_chamber = _tube(q, s)
    gain = h * stiffness / q.line_volume
    s.line += gain * (booster - into_chamber) / (1.0 - gain * booster_slope)
    if q.diaphragm_hole > 0.0:
        into_chamber -= _hole(q, s)
    volume = q.chamber_volume + AREA * s.x
    squeeze = q.polytropic * (s.chamber + ATMOSPHERE) * AREA * s.v
    s.chamber += h * (stiffness * into_chamber - squeeze) / volume


@compiled
def _spring_rate(q: Any, s: Any) -> float:
    rate = q.spring
    if q.thermal_spring > 0.0:
        rate *= 1.0 + q.thermal_spring * math.sin(2.0 * math.pi * (s.time / _HEATING_S + uniform(s.seed, PHASE, 2)))
    return float(rate)


@compiled
def _spring_force(q: Any, s: Any) -> float:
    share = s.x / q.travel
    # the integral of a rate that goes from (1 - size) to (1 + size) over the stroke
    force = q.preload + _spring_rate(q, s) * s.x * (1.0 - q.nonlinear_spring * (1.0 - share))
    if q.snap_region > 0.0:
        force -= q.snap_region * PSI * AREA * (0.5 + 0.5 * math.tanh((share - 0.5) / 0.06))
    return float(force)


@compiled
def _fluid_force(q: Any, s: Any) -> float:
    opening = min(max(1.0 - s.x / q.travel, 0.0), 1.0)
    return float(q.flow_force * PSI * _PLUG_M2 * 4.0 * opening * (1.0 - opening))


@compiled
def _relaxing(q: Any, s: Any, v: float, h: float) -> float:
    total = 0.0
    for index in range(2):
        s.relax[index] += h * (0.5 * q.creep * q.spring * v - s.relax[index] / _RELAX_S[index])
        total += s.relax[index]
    return total


@compiled
def _contact(q: Any, s: Any, h: float) -> tuple[float, float]:
    """Force of the end stops as `force + slope * v` in the speed at the end of the step."""
    low = q.reduced_travel * INCH if q.reduced_travel_form == 1 else 0.0
    high = q.travel - (q.reduced_travel * INCH if q.reduced_travel_form == 0 else 0.0)
    depth = s.x - high if s.x > high else min(s.x - low, 0.0)
    if depth == 0.0:
        return 0.0, 0.0
    return float(q.stop_stiffness * depth), float(q.stop_stiffness * h + q.stop_damping)


@compiled
def _damper(q: Any, s: Any) -> tuple[float, float]:
    """The hydraulic damper as `force + slope * v` around the present speed: a gap, then the flow regulator."""
    drag = q.damper
    ahead = q.travel - s.x
    if s.v < 0.0:
        drag /= 1.0 + q.asymmetric_damping
        ahead = s.x
    bound = min(q.damper_speed, max(ahead, 0.0) / q.damper_taper + _SHUT_M_S)
    if abs(s.v) <= bound:
        return 0.0, float(drag)
    return float(-math.copysign(q.damper_over * bound, s.v)), float(drag + q.damper_over)


@compiled
def _plug(q: Any, s: Any, h: float) -> float:
    """Moves the plug behind a worn coupling; returns the force with which it holds the stem back [N]."""
    if q.additional_lag == 0.0:
        s.plug = s.x
        return 0.0
    s.plug += (s.x - s.plug) * h / (q.additional_lag + h)
    return float(q.coupling * (s.x - s.plug))


@compiled
def push(q: Any, s: Any, h: float) -> None:
    """Moves the stem by `h` seconds: all stiff forces are linear in the new speed, which is then solved for."""
    area = AREA * (1.0 - q.area_loss * s.x / q.travel)
    drive = s.chamber * area - _spring_force(q, s) - _fluid_force(q, s) - _plug(q, s, h)
    if q.creep > 0.0:
        drive -= _relaxing(q, s, s.v, h)
    if q.distributed_hysteresis > 0.0:
        drive -= soft_rings(q, s, s.v, h)
    grip, grip_slope = bristles(q, s, h)
    stop, stop_slope = _contact(q, s, h)
    oil, oil_slope = _damper(q, s)
    gas = q.polytropic * (s.chamber + ATMOSPHERE) * area * area / (q.chamber_volume + AREA * s.x)
    slope = grip_slope + stop_slope + oil_slope + h * (q.spring + gas)
    v = (q.mass * s.v / h + drive - grip - stop - oil) / (q.mass / h + slope)
    settle_bristles(q, s, v, h)
    s.v = v
    s.x += h * v
