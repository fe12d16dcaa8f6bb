"""If-Then control with threshold line, integral part and anti-windup: figure 3-11, the last word of the thesis."""

from __future__ import annotations

from dataclasses import dataclass, replace

from control.controller import Law, Seen
from control.if_then import Decision, threshold_line_psi


@dataclass(frozen=True, slots=True)
class IfThenPiState:
    """The last decision, the integral part [psi]."""

    decision: Decision
    integral_psi: float


@dataclass(frozen=True)
class IfThenPi(Law[IfThenPiState]):
    """P_signal = P_measurement (+- deadband) + Kp e + I every `update_s` [s], dI/dt = Ki e in the times between.

    `kp` [psi/in] of 0 means 1 / compliance; `ki` is in psi/(in s). Anti-windup: the integral stands still while the
    pressure has to cross the deadband or sits at a command limit, or while the error is beyond `window_in`, and stays
    within +-`integral_max_psi`. It takes over like the other two, see `control/if_then.py`.
    """

    kp: float = 0.0
    ki: float = 0.15
    update_s: float = 9.0
    window_in: float = 0.03
    integral_max_psi: float = 0.3
    tolerance_in: float = 0.0

    def start(self, seen: Seen, target_in: float) -> IfThenPiState:
        return IfThenPiState(Decision(0.0, seen.commanded_psi, target_in), 0.0)

    def law(self, state: IfThenPiState, seen: Seen, target_in: float, dt_s: float) -> tuple[IfThenPiState, float]:
        last = state.decision
        if not last.due(dt_s):
            return IfThenPiState(last.later(dt_s), state.integral_psi), last.command_psi
        error_in = target_in - seen.position_in
        if last.left_alone(target_in, error_in, self.tolerance_in):
            return replace(state, decision=replace(last, wait_s=self.update_s - dt_s)), last.command_psi
        d = self.design
        line_psi = threshold_line_psi(seen.position_in, d.compliance, d.a1, d.a2)
        jump_psi = last.jump_psi(error_in, seen, line_psi, d)
        integral_psi = state.integral_psi
        if not jump_psi and abs(error_in) <= self.window_in and self.min_psi < last.command_psi < self.max_psi:
            room_psi = self.integral_max_psi
            integral_psi = min(max(integral_psi + self.ki * error_in * self.update_s, -room_psi), room_psi)
        asked_psi = seen.pressure_psi + jump_psi + (self.kp or 1.0 / d.compliance) * error_in + integral_psi
        decision = Decision(self.update_s - dt_s, self.clamp(asked_psi), None, last.placed or jump_psi != 0.0)
        return IfThenPiState(decision, integral_psi), asked_psi


CONTROLLER = IfThenPi
