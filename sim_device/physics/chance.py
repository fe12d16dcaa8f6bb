"""Random numbers that are a function of (seed, stream, counter): no hidden state, so any chunking of time replays.

Source: the finalizer of SplitMix64 (Steele, Lea & Flood, "Fast splittable pseudorandom number generators", 2014).
"""

from __future__ import annotations

import math

import numpy as np

from sim_device.physics.jit import compiled

# Streams: one per independent use, so that switching one imperfection on never changes the dice of another.
PRESSURE_WHITE, PRESSURE_COLOUR, POSITION_WHITE, POSITION_COLOUR, WANDER, PLACE = 1, 2, 3, 4, 5, 6
DROPOUT, REFRESH, STICKING, TELEGRAPH, DRIFT, PHASE = 7, 8, 9, 10, 11, 12


@compiled
def _mix(z: np.uint64) -> np.uint64:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@compiled
def uniform(seed: np.uint64, stream: int, counter: int) -> float:
    """Evenly distributed on (0, 1)."""
    key = _mix(np.uint64(seed) + np.uint64(stream) * np.uint64(0x9E3779B97F4A7C15))
    bits = _mix(key + np.uint64(counter) * np.uint64(0xD1342543DE82EF95)) >> np.uint64(11)
    return (float(bits) + 0.5) * 1.1102230246251565e-16


@compiled
def normal(seed: np.uint64, stream: int, counter: int) -> float:
    """Gaussian with zero mean and unit variance (Box and Muller)."""
    radius = math.sqrt(-2.0 * math.log(uniform(seed, stream, 2 * counter)))
    return radius * math.cos(2.0 * math.pi * uniform(seed, stream, 2 * counter + 1))
