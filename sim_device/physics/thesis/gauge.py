"""From the stem to the voltage of the LVDT: linkage, core, characteristic, drift, filter."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import DRIFT, TELEGRAPH, normal, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled

IMPERFECTIONS = (
    Imperfection(
        "lvdt_calibration",
        "sensor",
        "1",
        (0.0035, 0.01, 0.035),
        "The reading has a gain error of `size`, or is off by `size` of travel everywhere.",
        forms=("gain", "zero"),
        scales=(1.0, 0.62),
        limit=0.5,
        signed=True,
    ),
    Imperfection(
        "lvdt_nonlinearity",
        "sensor",
        "1",
        (0.004, 0.012, 0.04),
        "The reading departs from the straight line by up to `size` of travel: cubic, bulge or S.",
        forms=("cubic", "bulge", "s"),
        limit=0.2,
        signed=True,
    ),
    Imperfection(
        "lvdt_drift",
        "sensor",
        "in",
        (0.002, 0.006, 0.02),
        "The zero moves by `size`: evenly in 20 min, while warming up, or as a random walk of that size in 20 min.",
        forms=("ramp", "warm_up", "walk"),
        limit=0.2,
        signed=True,
    ),
    Imperfection(
        "linkage_lost_motion",
        "sensor",
        "in",
        (0.003, 0.009, 0.03),
        "Play of `size` between stem and core, free or with one half of it sprung.",
        forms=("free", "sprung"),
        limit=0.2,
    ),
    Imperfection(
        "sensor_lag",
        "sensor",
        "s",
        (0.08, 0.25, 0.8),
        "The reading is low-pass filtered with delay `size`, of first or second order.",
        forms=("first", "second"),
        limit=10.0,
    ),
    Imperfection(
        "command_crosstalk",
        "sensor",
        "1",
        (0.0009, 0.0027, 0.009),
        "The command current couples into the LVDT cable: `size` of travel per psi of departure from 9 psi.",
        limit=0.1,
        outsider=True,
    ),
    Imperfection(
        "loose_core",
        "sensor",
        "in",
        (0.0016, 0.005, 0.016),
        "The LVDT core is loose on its rod and jumps at random between two places `size` apart, every 15 s or so.",
        limit=0.2,
        outsider=True,
    ),
    Imperfection(
        "ripple_guide",
        "sensor",
        "in",
        (0.002, 0.006, 0.02),
        "The core wears in as the stem travels: its reading sways by `size` once in 8 strokes travelled.",
        limit=0.2,
        outsider=True,
    ),
)

_RUN_S = 1200.0
_WALK_TICK_S = 1.0
_JUMP_WINDOW_S = 5.0


@compiled
def _play(place: float, x: float, half: float) -> float:
    return min(max(place, x - half), x + half)


@compiled
def _core(q: Any, s: Any, x: float) -> float:
    half = 0.5 * q.linkage_lost_motion
    s.core = _play(s.core, x, half)
    if q.linkage_lost_motion_form == 0:
        return float(s.core)
    s.core_soft = _play(s.core_soft, x, 0.5 * half)
    return float(0.5 * (s.core + s.core_soft))


@compiled
def _jumped(q: Any, s: Any) -> float:
    window = math.floor(s.time / _JUMP_WINDOW_S)
    if s.drift_tick < window and uniform(s.seed, TELEGRAPH, window) < 0.35:
        s.jump = q.loose_core - s.jump
    s.drift_tick = max(s.drift_tick, window)
    return float(s.jump)


@compiled
def _curved(q: Any, x: float) -> float:
    z = min(max(x / q.travel, 0.0), 1.0)
    size = q.lvdt_nonlinearity * q.travel
    if q.lvdt_nonlinearity_form == 0:
        return float(size * 10.392304845413264 * (z - 0.5) * (0.25 - (z - 0.5) ** 2) * 2.0)
    if q.lvdt_nonlinearity_form == 1:
        return float(size * 4.0 * z * (1.0 - z))
    return float(size * math.sin(2.0 * math.pi * z))


@compiled
def _drifted(q: Any, s: Any) -> float:
    if q.lvdt_drift_form == 0:
        return float(q.lvdt_drift * s.time / _RUN_S)
    if q.lvdt_drift_form == 1:
        return float(q.lvdt_drift * (1.0 - math.exp(-s.time / 240.0)))
    tick = math.floor(s.time / _WALK_TICK_S)
    while s.walk_tick < tick:
        s.walk_tick += 1
        s.drift += q.lvdt_drift * math.sqrt(_WALK_TICK_S / _RUN_S) * normal(s.seed, DRIFT, s.walk_tick)
    return float(s.drift)


@compiled
def _filtered(q: Any, s: Any, y: float, h: float) -> float:
    if q.sensor_lag_form == 0:
        s.filter_1 += (y - s.filter_1) * (1.0 - math.exp(-h / q.sensor_lag))
        return float(s.filter_1)
    keep = math.exp(-2.0 * h / q.sensor_lag)
    s.filter_1 += (y - s.filter_1) * (1.0 - keep)
    s.filter_2 += (s.filter_1 - s.filter_2) * (1.0 - keep)
    return float(s.filter_2)


@compiled
def gauge(q: Any, s: Any, x: float, h: float) -> float:
    """The demodulated LVDT signal at the end of a step of `h` seconds [in]."""
    y = _core(q, s, x) if q.linkage_lost_motion > 0.0 else x
    if q.lvdt_nonlinearity != 0.0:
        y += _curved(q, y)
    if q.lvdt_calibration_form == 0:
        y *= 1.0 + q.lvdt_calibration
    else:
        y += q.lvdt_calibration * q.travel
    if q.lvdt_drift != 0.0:
        y += _drifted(q, s)
    if q.loose_core > 0.0:
        y += _jumped(q, s)
    if q.command_crosstalk > 0.0:
        y += q.command_crosstalk * q.travel * (s.delayed - 9.0)
    if q.ripple_guide > 0.0:
        s.travelled += abs(x - s.previous)
        s.previous = x
        y += q.ripple_guide * math.sin(2.0 * math.pi * s.travelled / (8.0 * q.travel))
    if q.sensor_lag > 0.0:
        y = _filtered(q, s, y, h)
    return y
