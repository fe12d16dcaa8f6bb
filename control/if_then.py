"""The thesis's If-Then rule, equation (3-1), shared by its three controllers."""

from __future__ import annotations

import math
from dataclasses import dataclass


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
