"""Open loop: the pressure on the line midway between the two curves. No feedback and no memory of the direction."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen
from control.handover import Bump


@dataclass(frozen=True)
class OpenLoop(Law[Bump]):
    """P_signal = offset + target / k. Right on average, wrong by up to half the deadband (0.28 in) in one direction.

    The difference to the command in force at the start fades out within about 3 `blend_s` [s].
    """

    blend_s: float = 2.0

    def start(self, seen: Seen, target_in: float) -> Bump:
        return Bump.from_command(seen.commanded_psi, self._line_psi(target_in))

    def law(self, state: Bump, seen: Seen, target_in: float, dt_s: float) -> tuple[Bump, float]:
        return state.fade(dt_s, self.blend_s), self._line_psi(target_in) + state.left_psi

    def _line_psi(self, target_in: float) -> float:
        return self.design.offset + target_in / self.design.compliance


CONTROLLER = OpenLoop
