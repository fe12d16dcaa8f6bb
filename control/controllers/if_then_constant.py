"""If-Then control with a constant threshold pressure (3-1): bounces where the curves come near the threshold."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen
from control.if_then import Decision, crossing_psi


@dataclass(frozen=True)
class IfThenConstant(Law[Decision]):
    """P_signal = P_measurement (+- deadband) + g e, every `update_s` [s].

    `g` [psi/in] of 0 means 1 / compliance, the slope of the curves. The thesis does not give the pace of its loop; the
    rule is a static calculation, so that it has to wait until the stem has settled before it may look again (the
    default, about 3.3 time constants of the thesis's valve). `tolerance_in` is the error that is left alone.
    """

    threshold_psi: float = 8.12
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
            jump_psi = crossing_psi(error_in, seen.pressure_psi, self.threshold_psi, self.design.deadband)
            command_psi = self.clamp(seen.pressure_psi + jump_psi + (self.g or 1.0 / self.design.compliance) * error_in)
        return Decision(self.update_s - dt_s, command_psi), command_psi


CONTROLLER = IfThenConstant
