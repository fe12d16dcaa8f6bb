"""The original pilot positioner in cascade around the valve that the thesis met first (section 1.2).

Nothing here scripts an outcome. Full stroke is missed because the pilot's air supply ends at 11.65 psi, where the
closing curve has reached 97 % (the valve needs 11.74); the steady error is the arc of the feedback lever; the hunting
is a relay pilot whose own deadband is narrower than what the stem still travels after the pilot has closed, and every
correction has to carry the pressure across the valve's 2.96 psi first, which makes it slow. A pilot deadband of 5 % of
travel instead of 1.2 % ends it, at the price of that error.
The packing's friction acts on the moving stem (`friction_in_motion` = 1 unless the effects say otherwise).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from sim_device.physics.imperfection import choose
from sim_device.physics.positioner.loop import advance
from sim_device.physics.thesis.plant import IMPERFECTIONS
from sim_device.physics.thesis.record import DesignNumbers, settings, start_state
from sim_device.valve import Outputs


@dataclass(frozen=True, slots=True)
class Pilot:
    """The positioner's own numbers: pressures in psi, times in s, `opens` and `closes` as shares of the stroke."""

    lever_rad: float = 0.62  # half of the angle that the feedback lever turns over the stroke
    arm_play: float = 0.004  # in, play of the feedback arm's pin
    opens: float = 0.012
    closes: float = 0.004
    supply: float = 11.65
    fill_tau: float = 8.0
    exhaust_tau: float = 40.0
    leak: float = 0.002  # psi/s through the pilot's seat while it holds
    seen_tau: float = 0.2


class PositionerValve:
    """Command in percent of stroke. Deterministic for its seed."""

    def __init__(
        self, seed: int, pilot: Pilot, design: DesignNumbers, effects: Mapping[str, float], noise: float
    ) -> None:
        self.pilot = pilot
        self.design = design
        numbers = asdict(pilot)
        self._pilot_settings = np.array([tuple(numbers.values())], dtype=[(name, "f8") for name in numbers])
        self._pilot_state = np.zeros(1, dtype=[("arm", "f8"), ("seen", "f8"), ("valve", "f8")])
        self.settings = settings(IMPERFECTIONS, design, choose(IMPERFECTIONS, effects), noise)
        self.state = start_state(seed)
        self._now_s: float | None = None
        # compiled here and not at the first request, whose master would not wait for it
        advance(self.settings, self.state.copy(), self._pilot_settings, self._pilot_state.copy(), 0.0, 0.0)

    def advance(self, to_time_s: float, command: float) -> Outputs:
        duration_s = 0.0 if self._now_s is None else max(to_time_s - self._now_s, 0.0)
        self._now_s = to_time_s if self._now_s is None else max(to_time_s, self._now_s)
        pressure_psi, position_in = advance(
            self.settings, self.state, self._pilot_settings, self._pilot_state, float(command), duration_s
        )
        return Outputs(pressure_psi, position_in, self.pilot.supply, 22.0)
