"""Gain-scheduled two-degree-of-freedom PI: fast through the deadband, gentle in contact, deadband estimated."""

from __future__ import annotations

from dataclasses import dataclass, replace

from control.controller import Law, Seen


@dataclass(frozen=True, slots=True)
class ScheduledState:
    """Command [psi]; target of the last tick and filtered position [in]; direction that the stem is pushed in; pressure
    where it was last seen moving [psi], and in which direction; estimated deadband [psi]; the mark beyond which
    the stem counts as moving [in]."""

    command_psi: float
    target_in: float
    filtered_in: float
    side: int
    turn_psi: float
    turn_side: int
    deadband_psi: float
    mark_in: float

    @property
    def crossing(self) -> bool:
        """Whether the pressure is on its way through the deadband."""
        return self.side != self.turn_side


@dataclass(frozen=True)
class ScheduledPi(Law[ScheduledState]):
    """Velocity-form PI on the measured position: dP = kp (b dr - dx) + ki e dt in contact.

    When the error asks for the other direction by more than `turn_in`, the estimated deadband (less 10 %, so that the
    rest is found gently) is added at once, and the integral runs `gap_gain` times faster until the stem moves; where
    it does, the deadband is learned. Errors within `tolerance_in` are left alone. Units: kp psi/in, ki psi/(in s).
    """

    kp: float = 2.6
    ki: float = 1.2
    setpoint_weight: float = 2.0
    gap_gain: float = 3.0
    turn_in: float = 0.0015
    tolerance_in: float = 0.0010
    learn: float = 0.5

    def start(self, seen: Seen, target_in: float) -> ScheduledState:
        d = self.design
        side = 1 if seen.pressure_psi - seen.position_in / d.compliance >= d.offset else -1
        edge = (d.a1 if side > 0 else d.a2) + seen.position_in / d.compliance
        return ScheduledState(
            seen.commanded_psi, seen.position_in, seen.position_in, side, edge, side, d.deadband, seen.position_in
        )

    def law(self, state: ScheduledState, seen: Seen, target_in: float, dt_s: float) -> tuple[ScheduledState, float]:
        share = min(dt_s / 0.4, 1.0)
        filtered_in = state.filtered_in + share * (seen.position_in - state.filtered_in)
        moved_in, jumped_in = filtered_in - state.filtered_in, target_in - state.target_in
        error_in = target_in - filtered_in
        state = self._watch(state, seen, filtered_in)
        command_psi = state.command_psi - self.kp * moved_in
        wrong_side = error_in * state.side < 0.0 and abs(error_in) > self.turn_in
        if wrong_side or abs(jumped_in) > 4.0 * self.turn_in:
            state = replace(state, side=1 if error_in > 0.0 else -1)
            command_psi = self._edge_psi(state) + self.setpoint_weight * self.kp * error_in
        if abs(error_in) > self.tolerance_in:
            pace = self.gap_gain if state.crossing else 1.0
            command_psi += self.ki * pace * max(min(error_in, 0.05), -0.05) * dt_s
        command_psi = self.clamp(command_psi)
        return replace(state, command_psi=command_psi, target_in=target_in, filtered_in=filtered_in), command_psi

    def _edge_psi(self, state: ScheduledState) -> float:
        """The pressure just before the edge on the side in use [psi]."""
        return state.turn_psi + (0.9 * state.side * state.deadband_psi if state.crossing else 0.0)

    def _watch(self, state: ScheduledState, seen: Seen, filtered_in: float) -> ScheduledState:
        """Learns the deadband when the stem starts to move; remembers the pressure while it moves."""
        passed_in = (filtered_in - state.mark_in) * state.side
        if abs(passed_in) < 0.002:
            return state
        state = replace(state, mark_in=filtered_in)
        if passed_in < 0.0:
            return state
        if not state.crossing:
            return replace(state, turn_psi=seen.pressure_psi)
        width_psi = abs(seen.pressure_psi - state.turn_psi)
        known_psi = state.deadband_psi
        low, high = 0.5 * self.design.deadband, 1.5 * self.design.deadband
        if low < width_psi < high:
            known_psi += self.learn * (width_psi - known_psi)
        return replace(state, turn_side=state.side, deadband_psi=known_psi, turn_psi=seen.pressure_psi)


CONTROLLER = ScheduledPi
