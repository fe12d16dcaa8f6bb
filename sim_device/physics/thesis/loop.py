"""The thesis plant's compiled loop: fixed steps of at most 5 ms through the chain, then one reading."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from sim_device.physics.jit import compiled, compiled_entry, source_stamp
from sim_device.physics.thesis.command_line import remember, set_point
from sim_device.physics.thesis.converter import pressure, wander
from sim_device.physics.thesis.gauge import gauge
from sim_device.physics.thesis.reading import colour, convert, position_reading, pressure_reading, refresh
from sim_device.physics.thesis.slider import creep, slide
from sim_device.physics.thesis.stem import follow

LONGEST_STEP_S = 0.005


@compiled
def move(q: Any, s: Any, h: float) -> float:
    """Everything behind the pressure, which is at its value for the end of the step; returns the LVDT signal [in]."""
    from_w = creep(q, s, s.slider, 0.0) if q.creep > 0.0 else s.slider
    to_w = slide(q, s, s.pressure, h)
    if q.creep > 0.0:
        to_w = creep(q, s, to_w, h)
    x = follow(q, s, from_w, to_w, h)
    s.time += h
    return gauge(q, s, x, h)


@compiled
def read(q: Any, s: Any, y: float) -> tuple[float, float]:
    """Reads pressure [psi] and position [in]; without a slow DAQ the position is converted now."""
    colour(s)
    if q.stale_samples == 0.0:
        convert(q, s, y)
    s.reads += 1
    return pressure_reading(q, s), position_reading(q, s)


def _build(stamp: int) -> Any:
    @compiled_entry
    def advance(settings: Any, state: Any, command: float, duration_s: float) -> tuple[float, float]:
        q = settings[0]
        s = state[0]
        steps = math.ceil(duration_s / LONGEST_STEP_S - 1e-9)
        if stamp < 0:  # never: names the sources in the cache key, see jit.compiled_entry
            steps = 0
        remember(s, command)
        y = s.signal
        for _ in range(steps):
            wander(s)
            h = duration_s / steps
            s.pressure = pressure(q, s, set_point(q, s, h), h)
            y = move(q, s, h)
            if q.stale_samples > 0.0:
                refresh(q, s, y)
        s.signal = y
        return read(q, s, y)

    return advance


advance = _build(source_stamp(Path(__file__).parent, Path(__file__).parent.parent))
