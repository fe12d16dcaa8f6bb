"""If-Then control with a constant threshold pressure (3-1): bounces where the curves come near the threshold."""

from __future__ import annotations

from dataclasses import dataclass

from control.if_then import IfThen


@dataclass(frozen=True)
class IfThenConstant(IfThen):
    """The rule (3-1) with one threshold pressure, `threshold_psi`, for all positions."""

    threshold_psi: float = 8.12

    def threshold_at_psi(self, position_in: float) -> float:
        return self.threshold_psi


CONTROLLER = IfThenConstant
