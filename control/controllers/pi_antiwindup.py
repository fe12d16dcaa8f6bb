"""Proportional-integral control with anti-windup: the integral follows what the bench really commanded."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen


@dataclass(frozen=True, slots=True)
class PiState:
    """The integral part [psi] and the command asked for last [psi]."""

    integral_psi: float
    asked_psi: float


@dataclass(frozen=True)
class ProportionalIntegralAntiWindup(Law[PiState]):
    """P_signal = I + Kp e, dI/dt = Ki e + (commanded - asked) / `tracking_s`; Kp in psi/in, Ki in psi/(in s).

    "Commanded" is what the sample reports as written, after every limit between here and the valve; the integral
    itself stays in the command range too. Source: back-calculation, Astrom and Hagglund, "PID Controllers", 2nd
    edition, section 3.5.
    """

    kp: float = 3.0
    ki: float = 1.0
    tracking_s: float = 1.0

    def start(self, seen: Seen, target_in: float) -> PiState:
        return PiState(seen.commanded_psi - self.kp * (target_in - seen.position_in), seen.commanded_psi)

    def law(self, state: PiState, seen: Seen, target_in: float, dt_s: float) -> tuple[PiState, float]:
        error_in = target_in - seen.position_in
        asked_psi = state.integral_psi + self.kp * error_in
        cut_psi = seen.commanded_psi - state.asked_psi
        share = min(dt_s / self.tracking_s, 1.0) if self.tracking_s > 0.0 else 1.0
        integral_psi = state.integral_psi + self.ki * error_in * dt_s + share * cut_psi
        return PiState(self.clamp(integral_psi), asked_psi), asked_psi


CONTROLLER = ProportionalIntegralAntiWindup
