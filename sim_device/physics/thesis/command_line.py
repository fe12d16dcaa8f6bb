"""From the command register to what the converter is asked for: dead time, calibration, deadband, pilot faults."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PHASE, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled
from sim_device.physics.thesis.record import MEMORY

IMPERFECTIONS = (
    Imperfection("dead_time", "ep", "s", (0.09, 0.26, 0.86), "Pressure answers only after a delay.", limit=30.0),
    Imperfection(
        "ep_calibration",
        "ep",
        "psi",
        (0.01, 0.03, 0.1),
        "Static error between command and pressure: a zero error, or a span error that is `size` at 15 psi and 0 at 3.",
        forms=("zero", "span"),
        scales=(1.0, 2.0),
        limit=5.0,
        signed=True,
    ),
    Imperfection(
        "ep_deadband",
        "ep",
        "psi",
        (0.04, 0.12, 0.35),
        "The converter holds until the command has moved by `size`, or follows it with play of width `size`.",
        forms=("hold", "play"),
        scales=(1.0, 0.5),
        limit=5.0,
    ),
    Imperfection(
        "supply_cycling",
        "ep",
        "psi",
        (0.014, 0.042, 0.14),
        "The compressor cuts in and out every 47 s and its sawtooth comes through the regulator.",
        limit=3.0,
        outsider=True,
    ),
    Imperfection(
        "pilot_limit_cycle",
        "ep",
        "psi",
        (0.05, 0.09, 0.18),
        "Above 7 psi the converter's pilot hunts between two bounds `size` either side of its set point.",
        limit=3.0,
        outsider=True,
    ),
)

_COMPRESSOR_PERIOD_S = 47.0
_COMPRESSOR_DUTY = 0.3
_PILOT_SLEW_PSI_PER_S = 0.35
_PILOT_THRESHOLD_PSI = 7.0


@compiled
def remember(s: Any, command: float) -> None:
    """Notes a command that comes into force now; when the memory is full, the oldest change is let through early."""
    newest = (s.command_head - 1) % MEMORY
    if s.command_head != s.command_tail and s.command_values[newest] == command:
        return
    if s.command_head == s.command_tail and s.delayed == command:
        return
    if (s.command_head + 1) % MEMORY == s.command_tail:
        s.delayed = s.command_values[s.command_tail]
        s.command_tail = (s.command_tail + 1) % MEMORY
    s.command_times[s.command_head] = s.time
    s.command_values[s.command_head] = command
    s.command_head = (s.command_head + 1) % MEMORY


@compiled
def _arrived(q: Any, s: Any, h: float) -> float:
    due = s.time + 0.5 * h - q.dead_time
    while s.command_tail != s.command_head and s.command_times[s.command_tail] <= due:
        s.delayed = s.command_values[s.command_tail]
        s.command_tail = (s.command_tail + 1) % MEMORY
    return float(s.delayed)


@compiled
def _held(q: Any, s: Any, u: float) -> float:
    if q.ep_deadband_form == 0:
        if abs(u - s.latched) > q.ep_deadband:
            s.latched = u
    else:
        half = 0.5 * q.ep_deadband
        s.latched = min(max(s.latched, u - half), u + half)
    return float(s.latched)


@compiled
def _sawtooth(time: float, phase: float) -> float:
    """Rises during the compressor's duty, falls while the tank empties; between -1 and 1."""
    share = (time / _COMPRESSOR_PERIOD_S + phase) % 1.0
    if share < _COMPRESSOR_DUTY:
        return 2.0 * share / _COMPRESSOR_DUTY - 1.0
    return 1.0 - 2.0 * (share - _COMPRESSOR_DUTY) / (1.0 - _COMPRESSOR_DUTY)


@compiled
def _hunt(q: Any, s: Any, u: float, h: float) -> float:
    if u < _PILOT_THRESHOLD_PSI:
        s.servo *= math.exp(-h / 0.5)
        return float(s.servo)
    if s.pilot == 0.0:
        s.pilot = 1.0
    s.servo += s.pilot * _PILOT_SLEW_PSI_PER_S * h
    if abs(s.servo) > q.pilot_limit_cycle:
        s.pilot = -1.0 if s.servo > 0.0 else 1.0
    return float(s.servo)


@compiled
def set_point(q: Any, s: Any, h: float) -> float:
    """What the converter is asked for during a step of `h` seconds [psi]."""
    u = _arrived(q, s, h)
    if q.ep_calibration_form == 0:
        u += q.ep_calibration
    else:
        u += q.ep_calibration * (u - 3.0) / 12.0
    if q.ep_deadband > 0.0:
        u = _held(q, s, u)
    if q.supply_cycling > 0.0:
        s.supply = 20.0 + 2.0 * _sawtooth(s.time, uniform(s.seed, PHASE, 0))
        u += q.supply_cycling * _sawtooth(s.time, uniform(s.seed, PHASE, 0))
    if q.pilot_limit_cycle > 0.0:
        u += _hunt(q, s, u, h)
    return float(u + q.noise * s.wander)
