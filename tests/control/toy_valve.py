"""A valve for tests, written from the equations in the interface document alone: plain Python, fine steps."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import FloatArray, Recording


@dataclass(frozen=True)
class Toy:
    """Numbers of a valve; `k1`, `k2` slopes of the closing and the opening curve."""

    ep_tau: float = 0.3
    a1: float = 8.78
    a2: float = 5.82
    k1: float = 0.19
    k2: float = 0.19
    tau: float = 2.7
    rate: float = 0.12
    travel: float = 0.5625


def respond(toy: Toy, time_s: FloatArray, command: FloatArray, step_s: float = 0.005) -> tuple[FloatArray, FloatArray]:
    """Pressure and position at `time_s`; `command[i]` holds over the interval up to row i. Starts open and at rest."""
    p = float(command[0])
    w = max(toy.k1 * (p - toy.a1), min(toy.k2 * (p - toy.a2), 0.0), 0.0)
    x = w
    pressure, position = [p], [x]
    for i in range(1, len(time_s)):
        gap = float(time_s[i] - time_s[i - 1])
        count = max(1, round(gap / step_s))
        h, u = gap / count, float(command[i])
        for _ in range(count):
            p = u + (p - u) * math.exp(-h / toy.ep_tau)
            before = w
            w = min(max(toy.k1 * (p - toy.a1), min(toy.k2 * (p - toy.a2), w), 0.0), toy.travel)
            moved = (0.5 * (before + w) - x) * (1.0 - math.exp(-h / toy.tau))
            x = min(max(x + min(max(moved, -toy.rate * h), toy.rate * h), 0.0), toy.travel)
        pressure.append(p)
        position.append(x)
    return np.array(pressure), np.array(position)


def record(
    toy: Toy, time_s: FloatArray, command: FloatArray, *, seed: int = 1, noise_p: float = 0.004, noise_x: float = 0.0006
) -> Recording:
    """A recording of the toy with white reading noise."""
    chance = np.random.default_rng(seed)
    pressure, position = respond(toy, time_s, command)
    return Recording(
        name=f"toy-{seed}",
        time_s=time_s,
        command=command,
        position=position + noise_x * chance.standard_normal(time_s.size),
        pressure=pressure + noise_p * chance.standard_normal(time_s.size),
    )


def random_steps(
    duration_s: float, period_s: float, *, low: float = 4.0, high: float = 13.0, seed: int = 1
) -> FloatArray:
    """A full stroke, then random levels held 2 to 12 s; one value per row."""
    chance = random.Random(seed)
    values: list[float] = []
    rows = round(duration_s / period_s)
    for level in (low, high, low):
        values += [level] * round(12.0 / period_s)
    while len(values) < rows:
        values += [chance.uniform(low, high)] * round(chance.uniform(2.0, 12.0) / period_s)
    return np.array(values[:rows])


def without_pressure(recording: Recording) -> Recording:
    return replace(recording, pressure=None)
