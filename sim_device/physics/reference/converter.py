"""The E/P converter: input card, flapper and nozzle, booster with supply and exhaust ports, pressure gauge."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PHASE, WANDER, normal, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled
from sim_device.physics.reference.air import flow
from sim_device.physics.reference.record import ATMOSPHERE, MEMORY, PSI

IMPERFECTIONS = (
    Imperfection(
        "dead_time", "ep", "s", (0.06, 0.2, 0.7), "The input card passes a command on only after its scan.", limit=30.0
    ),
    Imperfection(
        "ep_calibration",
        "ep",
        "psi",
        (0.0085, 0.025, 0.085),
        "The zero screw is off by `size`, or the span screw by `size` at 15 psi.",
        forms=("zero", "span"),
        scales=(1.0, 2.0),
        limit=5.0,
        signed=True,
    ),
    Imperfection(
        "ep_deadband",
        "ep",
        "psi",
        (0.02, 0.06, 0.21),
        "The booster's ports overlap: neither opens within half of `size` either side of balance.",
        limit=5.0,
    ),
    Imperfection(
        "fill_exhaust_asymmetry",
        "ep",
        "1",
        (0.9, 1.9, 5.0),
        "Dirt in the exhaust port cuts its conductance to 1/(1 + size); negative sizes are dirt in the supply port.",
        limit=1000.0,
        signed=True,
    ),
    Imperfection(
        "ep_rate_limit",
        "ep",
        "1",
        (0.9, 1.9, 5.0),
        "A clogged filter in the line behind the booster cuts both ports to 1/(1 + size) of their conductance.",
        limit=1000.0,
    ),
    Imperfection(
        "supply_saturation",
        "ep",
        "psi",
        (8.2, 8.28, 8.39),
        "The air supply is `size` below its 20 psi; the booster cannot give more than the supply has.",
        limit=19.0,
        spread=False,
    ),
    Imperfection(
        "supply_cycling",
        "ep",
        "psi",
        (0.45, 1.3, 4.4),
        "The supply swings by `size` with the compressor and lifts the nozzle by 3 % of that.",
        limit=15.0,
        outsider=True,
    ),
    Imperfection(
        "pilot_limit_cycle",
        "ep",
        "psi",
        (0.03, 0.15, 0.45),
        "The flapper's pivot sticks within `size` while its integrator pushes on, so the converter hunts by itself.",
        limit=3.0,
        outsider=True,
    ),
)

_PORT_LAMINAR = 0.999
_UNREST_TICK_S, _UNREST_TAU_S, _UNREST_PA = 0.25, 25.0, 0.003 * PSI
_COMPRESSOR_S = 61.0


@compiled
def enqueue(s: Any, command: float) -> None:
    """A command arrives at the input card [psi]; when the card's memory is full, the oldest takes effect early."""
    if command == s.newest:
        return
    if s.queue_count == MEMORY:
        s.command = s.queue_values[s.queue_first]
        s.queue_first = (s.queue_first + 1) % MEMORY
        s.queue_count -= 1
    place = (s.queue_first + s.queue_count) % MEMORY
    s.queue_times[place] = s.time
    s.queue_values[place] = command
    s.queue_count += 1
    s.newest = command


@compiled
def _dequeue(q: Any, s: Any) -> None:
    while s.queue_count > 0 and s.queue_times[s.queue_first] + q.dead_time <= s.time + 1e-9:
        s.command = s.queue_values[s.queue_first]
        s.queue_first = (s.queue_first + 1) % MEMORY
        s.queue_count -= 1


@compiled
def _unrest(s: Any) -> float:
    """Slow unrest of the nozzle [Pa], an Ornstein-Uhlenbeck walk."""
    tick = int(s.time / _UNREST_TICK_S)
    while s.unrest_tick < tick:
        s.unrest_tick += 1
        keep = math.exp(-_UNREST_TICK_S / _UNREST_TAU_S)
        s.unrest = keep * s.unrest + math.sqrt(1.0 - keep * keep) * normal(s.seed, WANDER, s.unrest_tick)
    return float(s.unrest * _UNREST_PA)


@compiled
def _wish(q: Any, s: Any, h: float) -> float:
    """The pressure that the electronics ask of the nozzle [Pa gauge]."""
    _dequeue(q, s)
    psi = s.command
    if q.ep_calibration_form == 0:
        psi += q.ep_calibration
    else:
        psi += q.ep_calibration * (psi - 3.0) / 12.0
    if q.supply_cycling > 0.0:
        swing = math.sin(2.0 * math.pi * (s.time / _COMPRESSOR_S + uniform(s.seed, PHASE, 0)))
        s.supply = 20.0 - q.supply_saturation + q.supply_cycling * swing
        psi += 0.03 * q.supply_cycling * swing
    if q.pilot_limit_cycle > 0.0:
        s.trim += (psi - s.line / PSI) * h / 8.0
        s.trim = min(max(s.trim, -1.5), 1.5)
        if abs(psi + s.trim - s.flapper) > q.pilot_limit_cycle:
            s.flapper = psi + s.trim
        psi = s.flapper
    return float(max(psi * PSI + q.noise * _unrest(s), 0.0))


@compiled
def ports(q: Any, s: Any, h: float) -> tuple[float, float]:
    """Moves the nozzle for `h` seconds; returns the booster's flow into the line [kg/s] and its slope [kg/(s Pa)].

    The slope with respect to the line pressure is what the implicit step of the line needs; it is never positive.
    """
    s.nozzle += (_wish(q, s, h) - s.nozzle) * h / q.nozzle_tau
    line = s.line + ATMOSPHERE
    error = s.nozzle - s.line
    dead = q.booster_overlap + 0.5 * q.ep_deadband * PSI
    source = (q.supply if q.supply_cycling == 0.0 else s.supply * PSI) + ATMOSPHERE
    if q.supply_cycling == 0.0:
        source -= q.supply_saturation * PSI
    clogged = q.port / (1.0 + q.ep_rate_limit)
    if error > dead:
        full = flow(clogged / (1.0 + max(-q.fill_exhaust_asymmetry, 0.0)), q.port_b, _PORT_LAMINAR, source, line)
    elif error < -dead:
        full = flow(clogged / (1.0 + max(q.fill_exhaust_asymmetry, 0.0)), q.port_b, _PORT_LAMINAR, line, ATMOSPHERE)
    else:
        return 0.0, 0.0
    opening = (error - dead if error > 0.0 else error + dead) / q.booster_span
    if opening >= 1.0:
        return full, 0.0
    if opening <= -1.0:
        return -full, 0.0
    return opening * full, -abs(full) / q.booster_span
