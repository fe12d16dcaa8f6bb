"""The valve as it really is, without its future: the plant's own equations, played along and ahead of the trial."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from control.scenarios import Scenario
from sim_device.physics.imperfection import choose
from sim_device.physics.thesis.loop import advance
from sim_device.physics.thesis.plant import IMPERFECTIONS, checked_design
from sim_device.physics.thesis.record import settings, start_state

NEVER = 1 << 60


class Ghost:
    """The scenario's plant, with all its true numbers and the state it starts in. Its chance is taken out: the unrest
    of the pilot is what it was `put` to, and its readings are not looked at."""

    def __init__(self, scenario: Scenario) -> None:
        design = checked_design(scenario.numbers)
        self.settings = settings(IMPERFECTIONS, design, choose(IMPERFECTIONS, scenario.effects), 1.0)
        self.state: NDArray[np.void] = start_state(0)
        self.state["wander_tick"] = NEVER  # so that the plant leaves its unrest alone
        self.gain = scenario.reading_gain

    def numbers(self, *names: str) -> tuple[float, ...]:
        """Settings of the plant, in its units."""
        return tuple(float(self.settings[name][0]) for name in names)

    def now(self, name: str) -> float:
        """One number of the state: `pressure`, `wander` [psi], `slider` (the plate) or `stem` [in]."""
        return float(self.state[name][0])

    def advance(self, command_psi: float, dt_s: float) -> None:
        """Plays along with what was in force."""
        advance(self.settings, self.state, command_psi, dt_s)

    def put(self, wander_psi: float, plate_by_in: float = 0.0, stem_by_in: float = 0.0) -> None:
        """What the readings have taught: the unrest of the pilot [psi], and how far plate and stem are off."""
        self.state["wander"] = wander_psi
        self.state["slider"] += plate_by_in
        for name in ("motion", "stem"):
            self.state[name] += stem_by_in

    def lands_in(self, commands_psi: Sequence[tuple[float, int]], dt_s: float) -> float:
        """Where the plate is after these commands [psi], each for a number of ticks; nothing is changed."""
        state: Any = self.state.copy()
        for command_psi, ticks in commands_psi:
            advance(self.settings, state, command_psi, ticks * dt_s)
        return float(state["slider"][0])
