"""The thesis's If-Then rule, equation (3-1), shared by its three controllers."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

from control.controller import Law, Seen


@dataclass(frozen=True, slots=True)
class Decision:
    """When the rule was last applied: `wait_s` until it is applied again, and what it said [psi]."""

    wait_s: float
    command_psi: float

    def due(self, dt_s: float) -> bool:
        """Whether the rule has to be applied in this tick; half a tick of slack absorbs rounding."""
        return self.wait_s <= 0.5 * dt_s

    def later(self, dt_s: float) -> Decision:
        """The same decision, one tick older."""
        return Decision(self.wait_s - dt_s, self.command_psi)


def crossing_psi(error_in: float, pressure_psi: float, threshold_psi: float, deadband_psi: float) -> float:
    """The deadband, with the error's sign, where the pressure is on the wrong side of the threshold; else 0 [psi]."""
    closing_from_low = error_in > 0.0 and pressure_psi < threshold_psi
    opening_from_high = error_in < 0.0 and pressure_psi > threshold_psi
    return math.copysign(deadband_psi, error_in) if closing_from_low or opening_from_high else 0.0


def threshold_line_psi(position_in: float, compliance: float, a1_psi: float, a2_psi: float) -> float:
    """Equation (3-3): the line midway between the two curves, (x + 0.5 k (a1 + a2)) / k."""
    return (position_in + 0.5 * compliance * (a1_psi + a2_psi)) / compliance


@dataclass(frozen=True)
class IfThen(Law[Decision]):
    """P_signal = P_measurement (+- deadband) + g e, every `update_s` [s]; where the threshold is, says the controller.

    `g` [psi/in] of 0 means 1 / compliance, the slope of the curves. The thesis does not give the pace of its loop; the
    rule is a static calculation, so that it has to wait until the stem has settled before it may look again (the
    default, about 3.3 time constants of the thesis's valve). `tolerance_in` is the error that is left alone.
    """

    g: float = 0.0
    update_s: float = 9.0
    tolerance_in: float = 0.0

    @abstractmethod
    def threshold_at_psi(self, position_in: float) -> float:
        """The pressure that tells one curve from the other at this position [psi]."""

    def start(self, seen: Seen, target_in: float) -> Decision:
        return Decision(0.0, seen.commanded_psi)

    def law(self, state: Decision, seen: Seen, target_in: float, dt_s: float) -> tuple[Decision, float]:
        if not state.due(dt_s):
            return state.later(dt_s), state.command_psi
        error_in = target_in - seen.position_in
        command_psi = state.command_psi
        if abs(error_in) > self.tolerance_in:
            threshold_psi = self.threshold_at_psi(seen.position_in)
            jump_psi = crossing_psi(error_in, seen.pressure_psi, threshold_psi, self.design.deadband)
            command_psi = self.clamp(seen.pressure_psi + jump_psi + (self.g or 1.0 / self.design.compliance) * error_in)
        return Decision(self.update_s - dt_s, command_psi), command_psi
