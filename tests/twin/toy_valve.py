"""A small valve for tests: lag, play, lag, in plain steps; written for these tests only, with switches for effects."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from logs.recording import Recording

FloatArray = npt.NDArray[np.float64]
TRAVEL = 0.5625


@dataclass(frozen=True)
class Toy:
    """What is true of the toy; the defaults are the design's numbers."""

    ep_tau_s: float = 0.3
    delay_s: float = 0.0
    a1: float = 8.78
    a2: float = 5.82
    compliance: float = 0.19
    tau_s: float = 2.7
    rate: float = 0.12
    breakaway: float = 0.0  # stick-slip: extra pressure to leave rest; then the stem jumps to its target

    def pressure(self, command: FloatArray, dt: float, start: float | None = None) -> FloatArray:
        late = round(self.delay_s / dt)
        delayed = np.concatenate([np.full(late, command[0]), command[: command.size - late]])
        decay = np.exp(-dt / self.ep_tau_s)
        out = np.empty_like(command)
        p = delayed[0] if start is None else start
        for i, u in enumerate(delayed):
            p = u + (p - u) * decay
            out[i] = p
        return out

    def position(self, pressure: FloatArray, dt: float) -> FloatArray:
        out = np.empty_like(pressure)
        w = x = 0.0
        for i, p in enumerate(pressure):
            low, high = self.compliance * (p - self.a1), self.compliance * (p - self.a2)
            reach = self.compliance * self.breakaway
            stuck = reach and low - w < reach and w - high < reach
            w = w if stuck else min(max(low, min(high, w), 0.0), TRAVEL)
            x += min(max((w - x) / self.tau_s, -self.rate), self.rate) * dt
            out[i] = x
        return out


def staircase(dt: float, hold_s: float, levels: list[float]) -> FloatArray:
    return np.repeat(np.asarray(levels), round(hold_s / dt))


def record(toy: Toy, command: FloatArray, dt: float, seed: int, sigma: float, sigma_p: float = 0.02) -> Recording:
    """A recording of the toy with white noise on both readings."""
    rng = np.random.default_rng(seed)
    pressure = toy.pressure(command, dt)
    return Recording(
        name=f"toy-{seed}",
        time_s=np.arange(command.size) * dt,
        command=command,
        position=toy.position(pressure, dt) + sigma * rng.standard_normal(command.size),
        pressure=pressure + sigma_p * rng.standard_normal(command.size),
    )


def with_position(recording: Recording, position: FloatArray) -> Recording:
    return replace(recording, position=position)
