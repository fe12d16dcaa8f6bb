"""The pilot positioner's compiled loop around the thesis plant's valve: lever, relay pilot, air."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from sim_device.physics.jit import compiled, compiled_entry, source_stamp
from sim_device.physics.thesis.loop import LONGEST_STEP_S, move, read
from sim_device.physics.thesis.reading import refresh

FILL, HOLD, EXHAUST = 1.0, 0.0, -1.0


@compiled
def lever(b: Any, stem: float, travel: float) -> float:
    """The stroke as the positioner sees it (0 to 1): a lever that turns, so an arc instead of a straight line."""
    share = stem / travel
    return float(0.5 + 0.5 * math.atan((2.0 * share - 1.0) * math.tan(b.lever_rad)) / b.lever_rad)


@compiled
def _pilot(b: Any, v: Any, error: float) -> None:
    """A relay with three positions: opens when the error leaves the deadband, closes again nearer to zero."""
    if v.valve == HOLD:
        if error > b.opens:
            v.valve = FILL
        elif error < -b.opens:
            v.valve = EXHAUST
    elif v.valve * error < b.closes:
        v.valve = HOLD


@compiled
def _air(b: Any, v: Any, p: float, h: float) -> float:
    """Pressure after `h` seconds of filling from the supply, exhausting to the room, or holding with a small leak."""
    if v.valve == FILL:
        return float(p + (b.supply - p) * h / b.fill_tau)
    if v.valve == EXHAUST:
        return float(p - p * h / b.exhaust_tau)
    return float(p - b.leak * h)


def _build(stamp: int) -> Any:
    @compiled_entry
    def advance(
        settings: Any, state: Any, pilot_settings: Any, pilot_state: Any, percent: float, duration_s: float
    ) -> tuple[float, float]:
        q, s, b, v = settings[0], state[0], pilot_settings[0], pilot_state[0]
        steps = math.ceil(duration_s / LONGEST_STEP_S - 1e-9)
        if stamp < 0:  # never: names the sources in the cache key, see jit.compiled_entry
            steps = 0
        y = s.signal
        for _ in range(steps):
            h = duration_s / steps
            v.arm = min(max(v.arm, s.stem - b.arm_play), s.stem + b.arm_play)
            v.seen += (lever(b, v.arm, q.travel) - v.seen) * h / b.seen_tau
            _pilot(b, v, 0.01 * percent - v.seen)
            s.pressure = max(_air(b, v, s.pressure, h), 0.0)
            y = move(q, s, h)
            if q.stale_samples > 0.0:
                refresh(q, s, y)
        s.signal = y
        return read(q, s, y)

    return advance


_HERE = Path(__file__).parent
advance = _build(source_stamp(_HERE, _HERE.parent, _HERE.parent / "thesis"))
