"""Family B: the valve from first principles, as independent of family A as one house can make it.

Its friction acts on the moving stem, inside the balance of forces. So `friction_in_motion` is not a fault that it can
have but what it is when healthy, and who diagnoses it is given a design that says so.
"""

from __future__ import annotations

from collections.abc import Mapping

from sim_device.physics.imperfection import Imperfection, choose
from sim_device.physics.reference import actuator, converter, packing, transducer
from sim_device.physics.reference.loop import advance
from sim_device.physics.reference.record import Build, settings, start_state
from sim_device.valve import Outputs

IMPERFECTIONS: tuple[Imperfection, ...] = (
    *converter.IMPERFECTIONS,
    *packing.IMPERFECTIONS,
    *actuator.IMPERFECTIONS,
    *transducer.IMPERFECTIONS,
)


class ReferenceValve:
    """Air, friction and masses in SI units, integrated in steps of at most 0.5 ms. Command in psi.

    Deterministic: what it says is a function of the seed and of the calls.
    """

    def __init__(self, seed: int, build: Build, effects: Mapping[str, float], noise: float) -> None:
        self.build = build
        self.settings = settings(IMPERFECTIONS, build, choose(IMPERFECTIONS, effects), noise)
        self.state = start_state(seed)
        self._now_s: float | None = None
        # compiled here and not at the first request, whose master would not wait for it
        advance(self.settings, self.state.copy(), 0.0, 0.0)

    def advance(self, to_time_s: float, command: float) -> Outputs:
        duration_s = 0.0 if self._now_s is None else max(to_time_s - self._now_s, 0.0)
        self._now_s = to_time_s if self._now_s is None else max(to_time_s, self._now_s)
        pressure_psi, position_in = advance(self.settings, self.state, float(command), duration_s)
        return Outputs(pressure_psi, position_in, float(self.state["supply"][0]), 22.0)
