"""The thesis's If-Then rule, equation (3-1), shared by its three controllers."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, replace

from control.controller import Law, Seen
from control.design import DesignModel

SEEN_IN = 0.0018  # three standard deviations of one reading: what is smaller may be noise


@dataclass(frozen=True, slots=True)
class Decision:
    """When the rule was last applied: `wait_s` until it is applied again, and what it said [psi].

    `rests_in` is the target at the hand-over, until it changes or is left; `placed`, whether the deadband has been
    crossed since: only then is it known on which curve the pressure is.
    """

    wait_s: float
    command_psi: float
    rests_in: float | None = None
    placed: bool = False

    def due(self, dt_s: float) -> bool:
        """Whether the rule has to be applied in this tick; half a tick of slack absorbs rounding."""
        return self.wait_s <= 0.5 * dt_s

    def later(self, dt_s: float) -> Decision:
        """The same decision, one tick older."""
        return replace(self, wait_s=self.wait_s - dt_s)

    def left_alone(self, target_in: float, error_in: float, tolerance_in: float) -> bool:
        """Whether nothing is to be done: the error is tolerable, or was handed over and cannot be told from noise."""
        noise_in = SEEN_IN if self.rests_in == target_in else 0.0
        return abs(error_in) <= max(tolerance_in, noise_in)

    def jump_psi(self, error_in: float, seen: Seen, threshold_psi: float, design: DesignModel) -> float:
        """The deadband where it has to be crossed, with its sign; the first time only as far as the curve [psi]."""
        jump_psi = crossing_psi(error_in, seen.pressure_psi, threshold_psi, design.deadband)
        return jump_psi if self.placed else to_the_curve_psi(jump_psi, seen, design)


def crossing_psi(error_in: float, pressure_psi: float, threshold_psi: float, deadband_psi: float) -> float:
    """The deadband, with the error's sign, where the pressure is on the wrong side of the threshold; else 0 [psi]."""
    closing_from_low = error_in > 0.0 and pressure_psi < threshold_psi
    opening_from_high = error_in < 0.0 and pressure_psi > threshold_psi
    return math.copysign(deadband_psi, error_in) if closing_from_low or opening_from_high else 0.0


def to_the_curve_psi(jump_psi: float, seen: Seen, design: DesignModel) -> float:
    """The jump, shortened to end on the curve that it is to reach, where it would go visibly beyond it [psi].

    Equation (3-1) adds the whole deadband, because it takes the pressure to be on the other curve. At a hand-over it
    may be anywhere between them; the whole deadband would then carry the stem along by what it is too much.
    """
    way, edge_psi = math.copysign(1.0, jump_psi), design.a1 if jump_psi > 0.0 else design.a2
    room_psi = max(way * (edge_psi + seen.position_in / design.compliance - seen.pressure_psi), 0.0)
    return way * room_psi if abs(jump_psi) > room_psi + SEEN_IN / design.compliance else jump_psi


def threshold_line_psi(position_in: float, compliance: float, a1_psi: float, a2_psi: float) -> float:
    """Equation (3-3): the line midway between the two curves, (x + 0.5 k (a1 + a2)) / k."""
    return (position_in + 0.5 * compliance * (a1_psi + a2_psi)) / compliance


@dataclass(frozen=True)
class IfThen(Law[Decision]):
    """P_signal = P_measurement (+- deadband) + g e, every `update_s` [s]; where the threshold is, says the controller.

    `g` [psi/in] of 0 means 1 / compliance, the slope of the curves. The thesis does not give the pace of its loop; the
    rule is a static calculation, so that it has to wait until the stem has settled before it may look again (the
    default, about 3.3 time constants of the thesis's valve). `tolerance_in` is the error that is left alone; at the
    target at which the valve was taken over it is at least three standard deviations of a reading, and the first
    crossing ends on the curve, not beyond it: so that taking over a valve at rest does not move it.
    """

    g: float = 0.0
    update_s: float = 9.0
    tolerance_in: float = 0.0

    @abstractmethod
    def threshold_at_psi(self, position_in: float) -> float:
        """The pressure that tells one curve from the other at this position [psi]."""

    def start(self, seen: Seen, target_in: float) -> Decision:
        return Decision(0.0, seen.commanded_psi, target_in)

    def law(self, state: Decision, seen: Seen, target_in: float, dt_s: float) -> tuple[Decision, float]:
        if not state.due(dt_s):
            return state.later(dt_s), state.command_psi
        error_in = target_in - seen.position_in
        if state.left_alone(target_in, error_in, self.tolerance_in):
            return replace(state, wait_s=self.update_s - dt_s), state.command_psi
        jump_psi = state.jump_psi(error_in, seen, self.threshold_at_psi(seen.position_in), self.design)
        command_psi = self.clamp(seen.pressure_psi + jump_psi + (self.g or 1.0 / self.design.compliance) * error_in)
        return Decision(self.update_s - dt_s, command_psi, None, state.placed or jump_psi != 0.0), command_psi
