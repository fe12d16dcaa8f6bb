"""Backlash inverse: PI on the position asks for a play output; the inverse makes it a pressure; its width adapts."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen
from control.observer import Inside, Observer


@dataclass(frozen=True, slots=True)
class InverseState:
    """The estimate of the inside at the next instant; the integral part [in]; the pressure aimed at [psi], and
    for how long it has not changed [s]."""

    inside: Inside
    integral_in: float
    aim_psi: float
    quiet_s: float = 0.0


@dataclass(frozen=True)
class InversePi(Law[InverseState]):
    """v = target + kp e + I, dI/dt = ki e; pressure v / k + (a1 to push the play output up to v, a2 to pull it down).

    Nothing moves while the play output is within `tolerance_in` [in] of v, or within four times that in the first
    `patience_s` after a move, in which the estimate calms down. Both edges, and with them the width of the
    inverse, adapt to the readings (observer); the integral runs while the error is within `window_in` and starts anew
    with every larger step. `kp` is a plain number, `ki` is in 1/s.
    Source: the inverse of Tao and Kokotovic, "Adaptive Control of Systems with Actuator and Sensor Nonlinearities",
    1996; the adaptation is an observer's, not theirs.
    """

    kp: float = 0.0
    ki: float = 0.02
    tolerance_in: float = 0.0011
    window_in: float = 0.01
    patience_s: float = 4.0
    omega: float = 1.4

    def start(self, seen: Seen, target_in: float) -> InverseState:
        return InverseState(Observer(self.design).start(seen), 0.0, seen.commanded_psi)

    def law(self, state: InverseState, seen: Seen, target_in: float, dt_s: float) -> tuple[InverseState, float]:
        observer = Observer(self.design)
        omega = max(self.omega / (1.0 + 0.5 * state.quiet_s), 0.25)
        keep, soon = observer.track(state.inside, seen, dt_s, omega)
        error_in = target_in - soon.x
        near = abs(error_in) < self.window_in
        integral_in = state.integral_in + self.ki * error_in * dt_s if near else 0.0
        integral_in = min(max(integral_in, -self.window_in), self.window_in)
        aim_psi = self._aim_psi(soon, target_in + self.kp * error_in + integral_in, state)
        quiet_s = state.quiet_s + dt_s if aim_psi == state.aim_psi else 0.0
        return InverseState(keep, integral_in, aim_psi, quiet_s), soon.command_for(aim_psi)

    def _aim_psi(self, inside: Inside, wish_in: float, state: InverseState) -> float:
        k, travel = self.design.compliance, self.design.travel
        allowed_in = self.tolerance_in * (4.0 if state.quiet_s < self.patience_s else 1.0)
        if 0.0 < wish_in < travel and abs(wish_in - inside.w) <= allowed_in:
            return state.aim_psi
        closing = wish_in >= travel or (wish_in > inside.w and wish_in > 0.0)
        return (inside.a1 if closing else inside.a2) + wish_in / k


CONTROLLER = InversePi
