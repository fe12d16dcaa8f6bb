"""One way in which a cause can show itself: how it is built into a valve, and how large it can be."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from bench.stranger.valve import Course, Valve

#: (valve, size, whatever else must be drawn) -> the valve with the cause; size 0 is the healthy valve.
Build = Callable[[Valve, float, np.random.Generator], Valve]


class Form(NamedTuple):
    """A cause of the vocabulary in one physical form; `smallest` and `largest` bound the size, in `unit`."""

    cause: str
    form: str
    stage: str  # "ep", "actuator", "sensor"
    unit: str
    smallest: float
    largest: float
    build: Build


def ep(valve: Valve, **fields: float) -> Valve:
    """The valve with other numbers in its converter."""
    return valve._replace(ep=valve.ep._replace(**fields))


def stem(valve: Valve, **fields: float) -> Valve:
    """The valve with other numbers in its actuator."""
    return valve._replace(stem=valve.stem._replace(**fields))


def sensor(valve: Valve, **fields: float) -> Valve:
    """The valve with other numbers in its sensor."""
    return valve._replace(sensor=valve.sensor._replace(**fields))


def daq(valve: Valve, **fields: Any) -> Valve:
    """The valve with other numbers in its acquisition."""
    return valve._replace(daq=valve.daq._replace(**fields))


def weather(valve: Valve, channel: int, course: Course) -> Valve:
    """The valve with one more disturbance over time."""
    return valve._replace(weather=(*valve.weather, (channel, course)))


def sign(rng: np.random.Generator) -> float:
    """-1 or +1."""
    return float(rng.choice([-1.0, 1.0]))
