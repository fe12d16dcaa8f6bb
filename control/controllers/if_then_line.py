"""If-Then control with the threshold line midway between the two curves, equations (3-1) and (3-3)."""

from __future__ import annotations

from dataclasses import dataclass

from control.if_then import IfThen, threshold_line_psi


@dataclass(frozen=True)
class IfThenLine(IfThen):
    """The rule (3-1) with a threshold that follows the measured position."""

    def threshold_at_psi(self, position_in: float) -> float:
        return threshold_line_psi(position_in, self.design.compliance, self.design.a1, self.design.a2)


CONTROLLER = IfThenLine
