"""If-Then control with the threshold line midway between the two curves, equations (3-1) and (3-3)."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen
from control.if_then import Decision, crossing_psi, threshold_line_psi


@dataclass(frozen=True)
class IfThenLine(Law[Decision]):
    """P_signal = P_measurement (+- deadband) + g e, every `update_s` [s]; the threshold follows the measured position.

    The settings are those of `if_then_constant`, without the constant.
    """

    g: float = 0.0
    update_s: float = 9.0
    tolerance_in: float = 0.0

    def start(self, seen: Seen, target_in: float) -> Decision:
        return Decision(0.0, seen.commanded_psi)

    def law(self, state: Decision, seen: Seen, target_in: float, dt_s: float) -> tuple[Decision, float]:
        if not state.due(dt_s):
            return state.later(dt_s), state.command_psi
        error_in = target_in - seen.position_in
        command_psi = state.command_psi
        if abs(error_in) > self.tolerance_in:
            d = self.design
            line_psi = threshold_line_psi(seen.position_in, d.compliance, d.a1, d.a2)
            jump_psi = crossing_psi(error_in, seen.pressure_psi, line_psi, d.deadband)
            command_psi = self.clamp(seen.pressure_psi + jump_psi + (self.g or 1.0 / d.compliance) * error_in)
        return Decision(self.update_s - dt_s, command_psi), command_psi


CONTROLLER = IfThenLine
