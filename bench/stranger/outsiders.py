"""Causes that the vocabulary has no word for; the right answer to them is that something is unexplained."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.stranger.form import Form, sign, stem, weather
from bench.stranger.valve import LEAK_SHARE, LOCKED, READING_IN, SPRING_PSI, TARGET_PSI, Valve

_LONGEST_S = 4000.0  # no session is longer


def supply_ripple(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The compressor's cycle comes through the converter."""
    period_s = float(rng.uniform(12.0, 40.0))
    return weather(valve, TARGET_PSI, lambda time_s: size * np.sin(2.0 * np.pi * time_s / period_s))


def vibration(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """A pump nearby shakes the LVDT's core."""
    period_s = float(rng.uniform(0.9, 3.0))
    return weather(valve, READING_IN, lambda time_s: size * np.sin(2.0 * np.pi * time_s / period_s))


def spring_temperature(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The hot oil's temperature cycle softens and stiffens the springs."""
    period_s, phase = float(rng.uniform(60.0, 150.0)), float(rng.uniform(0.0, 6.28))
    return weather(valve, SPRING_PSI, lambda time_s: size * np.sin(2.0 * np.pi * time_s / period_s + phase))


def sticking_spells(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The stem is held fast now and then; `size` is the mean length of a spell [s]."""
    starts_s = np.cumsum(rng.exponential(40.0, 200))
    lengths_s = rng.uniform(0.5, 1.5, 200)

    def held(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        spell = np.maximum(np.searchsorted(starts_s, time_s) - 1, 0)
        since_s = time_s - starts_s[spell]
        return np.where((since_s >= 0.0) & (since_s < size * lengths_s[spell]), 1.0, 0.0)

    return weather(valve, LOCKED, held)


def growing_leak(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """The diaphragm loses more and more of the pressure that the converter measures: `size` in ten minutes."""
    return weather(valve, LEAK_SHARE, lambda time_s: size * time_s / 600.0)


def snap_through(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """A buckled spring cannot rest within `size` of one place: the stem is thrown over it."""
    return stem(valve, snap_half_in=size, snap_at_in=float(rng.uniform(0.15, 0.4)))


def crosstalk(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """Another channel's command, on and off at random, adds to ours."""
    switches_s = np.cumsum(rng.exponential(15.0, 1000))
    way = sign(rng)

    def bias(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(way * size * (np.searchsorted(switches_s, time_s) % 2), dtype=np.float64)

    return weather(valve, TARGET_PSI, bias)


def supply_sags(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """A neighbour takes air: the pressure sags at random and recovers."""
    starts_s = np.cumsum(rng.exponential(35.0, int(_LONGEST_S / 20.0)))
    recovery_s = float(rng.uniform(2.0, 6.0))

    def sag(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        since_s = time_s[:, None] - starts_s[None, :]
        shapes = np.where(since_s >= 0.0, np.exp(-np.maximum(since_s, 0.0) / recovery_s), 0.0)
        return -size * np.asarray(shapes.sum(axis=1))

    return weather(valve, TARGET_PSI, sag)


OUTSIDERS = (
    Form("outsider:supply_ripple", "sine", "ep", "psi", 0.005, 1.0, supply_ripple),
    Form("outsider:vibration", "sine", "sensor", "in", 0.001, 0.06, vibration),
    Form("outsider:spring_temperature", "sine", "actuator", "psi", 0.005, 1.0, spring_temperature),
    Form("outsider:sticking_spells", "random", "actuator", "s", 0.2, 25.0, sticking_spells),
    Form("outsider:growing_leak", "straight", "actuator", "1", 0.001, 0.1, growing_leak),
    Form("outsider:snap_through", "jump", "actuator", "in", 0.003, 0.09, snap_through),
    Form("outsider:crosstalk", "random", "ep", "psi", 0.005, 1.0, crosstalk),
    Form("outsider:supply_sags", "random", "ep", "psi", 0.01, 1.5, supply_sags),
)
