"""Proportional-integral control as first tried in section 3.1.2: nothing stops the integral at the pressure limits."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen


@dataclass(frozen=True)
class ProportionalIntegral(Law[float]):
    """P_signal = I + Kp e, dI/dt = Ki e; Kp in psi/in, Ki in psi/(in s). The state is the integral part I [psi]."""

    kp: float = 3.0
    ki: float = 1.0

    def start(self, seen: Seen, target_in: float) -> float:
        return seen.commanded_psi - self.kp * (target_in - seen.position_in)

    def law(self, state: float, seen: Seen, target_in: float, dt_s: float) -> tuple[float, float]:
        error_in = target_in - seen.position_in
        return state + self.ki * error_in * dt_s, state + self.kp * error_in


CONTROLLER = ProportionalIntegral
