"""How large a fault is against the noise of the readings: the scale on which every blind result is sorted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.blind.designs import margin
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record

if TYPE_CHECKING:
    from logs.recording import FloatArray
    from sim_device.sealed import Label

#: Edges of the strata, in units of the floor.
EDGES = (1.0, 3.0, 10.0)
STRATA = ("below 1", "1 to 3", "3 to 10", "above 10")


@dataclass(frozen=True, slots=True)
class Strength:
    """`gap_in`: RMS by which the faults move the position reading. `noise_in`: RMS of that reading's noise.

    `floor_in`: the noise together with the margin by which the healthy machine departs from its baseline. `alone_in`:
    the gap of each fault without the others. All in in.
    """

    gap_in: float
    noise_in: float
    floor_in: float
    alone_in: tuple[float, ...] = ()

    @property
    def ratio(self) -> float:
        """Fault over floor; 0 for a healthy valve."""
        return self.gap_in / self.floor_in

    @property
    def weakest(self) -> float:
        """The least of the faults, as if it were alone, over the floor; 0 for a healthy valve."""
        return min(self.alone_in, default=0.0) / self.floor_in


def strength(label: Label, time_s: FloatArray, command: FloatArray) -> Strength:
    """Plays a command, shape (n,), to the valve with and without its faults, both without noise, and compares.

    This is the raw distance, before any re-tuning of the model's own numbers. It needs the truth, so it can only be
    worked out after the seal is broken.
    """
    effects = {cause.key: cause.size for cause in label.causes}

    def read(noise: float, faults: dict[str, float]) -> FloatArray:
        physics = make_physics(label.family, label.physics_seed, effects=faults, noise=noise)
        return record(physics, time_s, command)[1]

    healthy = read(0.0, {})
    noise = _rms(read(1.0, {}) - healthy)
    gap = _rms(read(0.0, effects) - healthy) if effects else 0.0
    single = [{name: size} for name, size in effects.items()]
    alone = [_rms(read(0.0, fault) - healthy) for fault in single] if len(single) > 1 else [gap] * len(single)
    return Strength(gap, noise, float(np.hypot(noise, margin(label.family).position)), tuple(alone))


def stratum(ratio: float) -> str:
    """The name of the stratum that a ratio falls into."""
    return STRATA[int(np.searchsorted(EDGES, ratio, side="right"))]


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
