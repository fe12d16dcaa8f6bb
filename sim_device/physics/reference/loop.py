"""The reference valve's compiled loop: steps of half a millisecond, stiff parts implicit."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from sim_device.physics.jit import compiled_entry, source_stamp
from sim_device.physics.reference.actuator import fill, push
from sim_device.physics.reference.converter import enqueue, ports
from sim_device.physics.reference.transducer import registers, sense

LONGEST_STEP_S = 0.0005


def _build(stamp: int) -> Any:
    @compiled_entry
    def advance(settings: Any, state: Any, command: float, duration_s: float) -> tuple[float, float]:
        q = settings[0]
        s = state[0]
        steps = math.ceil(duration_s / LONGEST_STEP_S - 1e-9)
        if stamp < 0:  # never: names the sources in the cache key, see jit.compiled_entry
            steps = 0
        enqueue(s, command)
        for _ in range(steps):
            h = duration_s / steps
            booster, slope = ports(q, s, h)
            fill(q, s, booster, slope, h)
            push(q, s, h)
            s.time += h
            sense(q, s, h)
        return registers(q, s)

    return advance


advance = _build(source_stamp(Path(__file__).parent, Path(__file__).parent.parent))
