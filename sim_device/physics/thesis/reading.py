"""From the signals to what a reader is told: noise, refresh, resolution, false readings."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import (
    DROPOUT,
    POSITION_COLOUR,
    POSITION_WHITE,
    PRESSURE_COLOUR,
    PRESSURE_WHITE,
    REFRESH,
    normal,
    uniform,
)
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled

IMPERFECTIONS = (
    Imperfection(
        "stale_samples",
        "sensor",
        "s",
        (0.15, 0.45, 1.5),
        "The DAQ has a new position only every `size`, evenly or with 40 % jitter; in between it repeats the last.",
        forms=("even", "jitter"),
        limit=30.0,
    ),
    Imperfection(
        "sensor_quantization",
        "sensor",
        "in",
        (0.005, 0.015, 0.05),
        "The reading comes in steps of `size`, rounded or cut off.",
        forms=("round", "floor"),
        limit=0.2,
    ),
    Imperfection(
        "sensor_dropouts",
        "sensor",
        "1",
        (0.002, 0.008, 0.03),
        "This share of the readings is false: zero, the end of the range, or a spike of random height.",
        forms=("zero", "full_scale", "spike"),
        limit=0.5,
    ),
)

PRESSURE_NOISE_PSI, POSITION_NOISE_IN = 0.004, 0.0006
_WHITE, _COLOUR = 0.9, 0.4358898943540673  # their squares add to 1
_COLOUR_TICK_S, _COLOUR_KEEP = 0.05, 0.8464817248906141  # a correlation time of 0.3 s


@compiled
def colour(s: Any) -> None:
    """The slow part of the noise, unit variance, as a function of time alone."""
    tick = math.floor(s.time / _COLOUR_TICK_S)
    kick = math.sqrt(1.0 - _COLOUR_KEEP * _COLOUR_KEEP)
    s.colour_tick = max(s.colour_tick, tick - 100)
    while s.colour_tick < tick:
        s.colour_tick += 1
        s.colour_p = _COLOUR_KEEP * s.colour_p + kick * normal(s.seed, PRESSURE_COLOUR, s.colour_tick)
        s.colour_x = _COLOUR_KEEP * s.colour_x + kick * normal(s.seed, POSITION_COLOUR, s.colour_tick)


@compiled
def convert(q: Any, s: Any, y: float) -> None:
    """The DAQ takes a sample: noise and resolution."""
    white = normal(s.seed, POSITION_WHITE, s.refreshes)
    s.refreshes += 1
    y += q.noise * POSITION_NOISE_IN * (_WHITE * white + _COLOUR * s.colour_x)
    if q.sensor_quantization > 0.0:
        steps = y / q.sensor_quantization
        y = q.sensor_quantization * (math.floor(steps + 0.5) if q.sensor_quantization_form == 0 else math.floor(steps))
    s.shown = y


@compiled
def refresh(q: Any, s: Any, y: float) -> None:
    """Takes a sample when the DAQ's own clock says so; s.time is the end of the step."""
    if s.time < s.next_refresh:
        return
    period = q.stale_samples
    if q.stale_samples_form == 1:
        period *= 0.6 + 0.8 * uniform(s.seed, REFRESH, s.refreshes)
    s.next_refresh = max(s.next_refresh + period, s.time)
    colour(s)
    convert(q, s, y)


@compiled
def position_reading(q: Any, s: Any) -> float:
    """What the register of the DAQ holds when it is read now [in]."""
    if uniform(s.seed, DROPOUT, 2 * s.reads) >= q.sensor_dropouts:
        return float(s.shown)
    if q.sensor_dropouts_form == 0:
        return 0.0
    if q.sensor_dropouts_form == 1:
        return float(1.1 * q.travel)
    return float(q.travel * uniform(s.seed, DROPOUT, 2 * s.reads + 1))


@compiled
def pressure_reading(q: Any, s: Any) -> float:
    """What the converter's own gauge says now [psi]."""
    white = normal(s.seed, PRESSURE_WHITE, s.reads)
    return float(s.pressure + q.noise * PRESSURE_NOISE_PSI * (_WHITE * white + _COLOUR * s.colour_p))
