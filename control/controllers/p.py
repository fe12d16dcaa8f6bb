"""Proportional control, the positional reading of the thesis's section 3.1.1: a fixed bias plus Kp times the error."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen
from control.handover import Bump


@dataclass(frozen=True)
class Proportional(Law[Bump]):
    """P_signal = bias + Kp (target - position), Kp in psi/in (the thesis prints Kp = 3 without a unit).

    The bias is the pressure of the midway line at half travel (8.78 psi for the thesis's numbers): with Kp = 3 psi/in
    the whole range of the error then moves the pressure by +-0.84 psi, which is less than the deadband.
    """

    kp: float = 3.0
    blend_s: float = 2.0

    def start(self, seen: Seen, target_in: float) -> Bump:
        return Bump.from_command(seen.commanded_psi, self._positional_psi(seen.position_in, target_in))

    def law(self, state: Bump, seen: Seen, target_in: float, dt_s: float) -> tuple[Bump, float]:
        return state.fade(dt_s, self.blend_s), self._positional_psi(seen.position_in, target_in) + state.left_psi

    def _positional_psi(self, position_in: float, target_in: float) -> float:
        bias_psi = self.design.offset + 0.5 * self.design.travel / self.design.compliance
        return bias_psi + self.kp * (target_in - position_in)


CONTROLLER = Proportional
