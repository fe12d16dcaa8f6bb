"""The two records that the thesis plant's compiled loop works on: settings (constant) and state.

A settings record has the design numbers, the noise, and for every imperfection `NAME` its size `NAME` in natural units
and the number of its form `NAME_form`. Pressures are in psi, positions in in, times in s.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from sim_device.physics.imperfection import Chosen, Imperfection, fields, write

PLAYS = 7  # friction elements of the distributed hysteresis
MEMORY = 512  # command changes that a dead time can hold


@dataclass(frozen=True, slots=True)
class DesignNumbers:
    """The healthy valve. Source: thesis table 2-1 and section 2.2; `ep_tau` and `rate_limit` are this house's."""

    ep_tau: float = 0.30
    a1: float = 8.78
    a2: float = 5.82
    compliance: float = 0.19
    tau: float = 2.7
    rate_limit: float = 0.12
    travel: float = 0.5625


STATE = np.dtype(
    [
        ("seed", "u8"),
        ("time", "f8"),
        ("reads", "i8"),
        # command line
        ("command_times", "f8", (MEMORY,)),
        ("command_values", "f8", (MEMORY,)),
        ("command_head", "i8"),
        ("command_tail", "i8"),
        ("delayed", "f8"),
        ("latched", "f8"),
        ("pilot", "f8"),
        ("servo", "f8"),
        # pressures
        ("pressure", "f8"),
        ("reservoir", "f8"),
        ("supply", "f8"),
        ("wander", "f8"),
        ("wander_tick", "i8"),
        # actuator
        ("slider", "f8"),
        ("plays", "f8", (PLAYS,)),
        ("stuck", "f8"),
        ("quiet", "f8"),
        ("creep", "f8", (4,)),
        ("before", "f8"),
        ("motion", "f8"),
        ("stem", "f8"),
        # sensor
        ("core", "f8"),
        ("core_soft", "f8"),
        ("jump", "f8"),
        ("filter_1", "f8"),
        ("filter_2", "f8"),
        ("travelled", "f8"),
        ("drift", "f8"),
        ("drift_tick", "i8"),
        ("walk_tick", "i8"),
        ("previous", "f8"),
        ("next_refresh", "f8"),
        ("refreshes", "i8"),
        ("colour_p", "f8"),
        ("colour_x", "f8"),
        ("colour_tick", "i8"),
        ("shown", "f8"),
        ("signal", "f8"),
    ]
)


def settings(
    known: tuple[Imperfection, ...], design: DesignNumbers, chosen: list[Chosen], noise: float
) -> NDArray[np.void]:
    """A settings record of shape (1,); `noise` scales all random parts of readings and pressure."""
    numbers = asdict(design)
    layout = [(name, "f8") for name in numbers] + [("noise", "f8"), *fields(known)]
    record = np.zeros(1, np.dtype(layout))
    for name, value in numbers.items():
        record[name] = value
    record["noise"] = noise
    write(record, chosen)
    return record


def start_state(seed: int) -> NDArray[np.void]:
    """A vented valve, fully open, at time 0; shape (1,)."""
    state = np.zeros(1, STATE)
    state["seed"] = np.uint64(seed & 0xFFFFFFFFFFFFFFFF)
    for tick in ("wander_tick", "drift_tick", "walk_tick", "colour_tick"):
        state[tick] = -1
    state["supply"] = 20.0
    return state
