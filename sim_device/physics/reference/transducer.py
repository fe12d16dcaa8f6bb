"""From the stem to a register: bracket, core, coil, demodulator, converter, interference; and the pressure gauge."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import (
    DRIFT,
    DROPOUT,
    POSITION_WHITE,
    PRESSURE_WHITE,
    REFRESH,
    TELEGRAPH,
    normal,
    uniform,
)
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled
from sim_device.physics.reference.record import INCH, PSI

IMPERFECTIONS = (
    Imperfection(
        "lvdt_calibration",
        "sensor",
        "1",
        (0.0033, 0.01, 0.033),
        "The conditioner's gain is off by `size`, or its zero by `size` of travel.",
        forms=("gain", "zero"),
        scales=(1.0, 0.64),
        limit=0.5,
        signed=True,
    ),
    Imperfection(
        "lvdt_nonlinearity",
        "sensor",
        "1",
        (0.0285, 0.085, 0.285),
        "The core leaves the coil's linear range: the sensitivity falls by `size` towards one end of the stroke.",
        limit=2.0,
    ),
    Imperfection(
        "lvdt_drift",
        "sensor",
        "in",
        (0.0016, 0.0048, 0.016),
        "The conditioner warms up after switch-on and moves its zero by `size`, with 400 s.",
        limit=0.2,
        signed=True,
    ),
    Imperfection(
        "linkage_lost_motion", "sensor", "in", (0.003, 0.009, 0.03), "The LVDT's bracket has `size` of play.", limit=0.2
    ),
    Imperfection(
        "sensor_lag",
        "sensor",
        "s",
        (0.08, 0.25, 0.8),
        "A filter capacitor too large delays the demodulated signal by `size` more.",
        limit=10.0,
    ),
    Imperfection(
        "stale_samples",
        "sensor",
        "s",
        (0.12, 0.35, 1.3),
        "The DAQ multiplexes other channels: it has a new position only every `size`, give or take a tenth.",
        limit=30.0,
    ),
    Imperfection(
        "sensor_quantization",
        "sensor",
        "in",
        (0.002, 0.006, 0.021),
        "The converter has lost its lower bits: its steps are `size`, and values are cut off.",
        limit=0.2,
    ),
    Imperfection(
        "sensor_dropouts",
        "sensor",
        "1",
        (0.002, 0.008, 0.03),
        "Interference flips one of the three upper bits of this share of the readings.",
        limit=0.5,
    ),
    Imperfection(
        "command_crosstalk",
        "sensor",
        "1",
        (0.00034, 0.001, 0.0034),
        "The command current flows back through the LVDT's ground: `size` of travel per psi above 3 psi.",
        limit=0.1,
        outsider=True,
    ),
    Imperfection(
        "loose_core",
        "sensor",
        "in",
        (0.0018, 0.0055, 0.018),
        "The core's nut is loose: a push in either direction may flip it between two places `size` apart.",
        limit=0.2,
        outsider=True,
    ),
    Imperfection(
        "bent_rod",
        "sensor",
        "in",
        (0.002, 0.006, 0.02),
        "The stem turns as it strokes and the bent core rod sways the reading by `size` every 2 strokes travelled.",
        limit=0.2,
        outsider=True,
    ),
)

_PRESSURE_NOISE_PSI, _POSITION_NOISE_IN = 0.004, 0.0006


@compiled
def _core_place(q: Any, s: Any) -> float:
    """Where the core is in its coil [m]."""
    half = 0.5 * q.linkage_lost_motion * INCH
    s.core = min(max(s.core, s.plug - half), s.plug + half)
    place = s.core
    if q.loose_core > 0.0:
        window = int(s.time / 3.0)
        if window > s.side_tick:
            s.side_tick = window
            if abs(s.v) > 2.0e-5 and uniform(s.seed, TELEGRAPH, window) < 0.4:
                s.side = q.loose_core * INCH - s.side
        place += s.side
    return float(place)


@compiled
def _coil(q: Any, s: Any, place: float, h: float) -> float:
    """What the coil and its electronics make of a core at `place` [m]."""
    if q.lvdt_nonlinearity > 0.0:
        # sensitivity 1 at the open end, falling with the square of the distance from it
        share = place / q.travel
        place -= q.lvdt_nonlinearity * q.travel * share**3 / 3.0
        place += q.lvdt_nonlinearity * q.travel * share / 3.0
    if q.lvdt_calibration_form == 0:
        place *= 1.0 + q.lvdt_calibration
    else:
        place += q.lvdt_calibration * q.travel
    place += q.lvdt_drift * INCH * (1.0 - math.exp(-s.time / 400.0))
    place += q.command_crosstalk * q.travel * (s.command - 3.0)
    if q.bent_rod > 0.0:
        s.rod += abs(s.v) * h
        place += q.bent_rod * INCH * math.sin(math.pi * s.rod / q.travel)
    return float(place)


@compiled
def sense(q: Any, s: Any, h: float) -> None:
    """Advances the demodulator by `h` seconds and lets the DAQ convert when it is time."""
    signal = _coil(q, s, _core_place(q, s), h)
    omega = 1.0 / (1.0 / q.filter_omega + 0.5 * q.sensor_lag / q.filter_damping)
    # second-order filter, semi-implicit in its rate
    damp = 2.0 * q.filter_damping * omega
    s.filter_rate = (s.filter_rate + h * omega * omega * (signal - s.filtered)) / (1.0 + h * damp)
    s.filtered += h * s.filter_rate
    if s.time >= s.next_refresh:
        period = q.daq_period
        if q.stale_samples > 0.0:
            period = q.stale_samples * (0.9 + 0.2 * uniform(s.seed, REFRESH, s.refreshes))
        s.next_refresh = max(s.next_refresh + period, s.time)
        _convert(q, s)


@compiled
def _convert(q: Any, s: Any) -> None:
    """One conversion: the noise of neighbouring conversions overlaps by half, so it is mildly coloured."""
    new = normal(s.seed, POSITION_WHITE, s.refreshes)
    old = normal(s.seed, POSITION_WHITE, s.refreshes - 1)
    s.refreshes += 1
    place = s.filtered + q.noise * _POSITION_NOISE_IN * INCH * (0.894427191 * new + 0.447213595 * old)
    step = q.daq_step
    if q.sensor_quantization > 0.0:
        step = q.sensor_quantization * INCH
    s.shown = step * math.floor(place / step)


@compiled
def registers(q: Any, s: Any) -> tuple[float, float]:
    """Pressure [psi] and position [in] as they are read now."""
    s.reads += 1
    white = normal(s.seed, PRESSURE_WHITE, s.reads)
    slow = normal(s.seed, DRIFT, s.reads // 4)
    pressure = s.line / PSI + q.noise * _PRESSURE_NOISE_PSI * (0.9 * white + 0.435889894 * slow)
    position = s.shown / INCH
    if uniform(s.seed, DROPOUT, 2 * s.reads) < q.sensor_dropouts:
        bit = 0.5 ** (1.0 + math.floor(3.0 * uniform(s.seed, DROPOUT, 2 * s.reads + 1)))
        position += bit if (position / bit) % 2.0 < 1.0 else -bit
    return float(pressure), float(position)
