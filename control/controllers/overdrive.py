"""Fastest safe move: drive the play output beyond the target, brake through the deadband, land on the target."""

from __future__ import annotations

import math
from dataclasses import dataclass

from control.controller import Law, Seen
from control.observer import Inside, Observer


@dataclass(frozen=True, slots=True)
class OverdriveState:
    """The estimate of the inside at the next instant; `drive` is +1 closing, -1 opening, 0 settling; the aim
    [psi]; for how long it has not changed [s]."""

    inside: Inside
    drive: int
    target_in: float
    aim_psi: float
    quiet_s: float = 0.0


@dataclass(frozen=True)
class Overdrive(Law[OverdriveState]):
    """If-Then on the *predicted end position* (the play output w) instead of on the measured one, with overdrive.

    Driving: w is put ahead of the stem, so far that the stem runs at its rate limit (or covers the distance in
    `approach_s`). It brakes when braking now lands nearer to the target than braking one tick later. Settling: where
    w is off by more than the tolerance, the pressure goes to the edge that moves it; otherwise nothing moves, so that
    there is no limit cycle. Pressure readings and edges are learned on the way (observer).

    `lead` sharpens the converter's response; `again_in` [in] is the miss that is worth a new drive; `same_in`,
    `back_in` are the tolerances for pushing on and for turning back through the deadband.
    """

    approach_s: float = 0.6
    lead: float = 2.0
    again_in: float = 0.012
    same_in: float = 0.0004
    back_in: float = 0.0011
    omega: float = 1.2

    def start(self, seen: Seen, target_in: float) -> OverdriveState:
        return OverdriveState(self._observer.start(seen), 0, seen.position_in, seen.commanded_psi)

    def law(self, state: OverdriveState, seen: Seen, target_in: float, dt_s: float) -> tuple[OverdriveState, float]:
        observer = self._observer
        now = observer.correct(state.inside, seen, dt_s, max(self.omega / (1.0 + 0.5 * state.quiet_s), 0.3))
        soon = observer.ahead(now, seen.commanded_psi, dt_s)
        drive = self._drive(state, soon, target_in, dt_s)
        aim_psi = self._drive_psi(soon, target_in, drive) if drive else self._settle_psi(soon, target_in, state.aim_psi)
        quiet_s = state.quiet_s + dt_s if aim_psi == state.aim_psi else 0.0
        return OverdriveState(soon, drive, target_in, aim_psi, quiet_s), self._command_psi(soon, aim_psi)

    @property
    def _observer(self) -> Observer:
        return Observer(self.design)

    def _drive(self, state: OverdriveState, soon: Inside, target_in: float, dt_s: float) -> int:
        miss_in = target_in - soon.x
        if state.drive and state.drive * miss_in > 0.0:
            return state.drive if self._is_early(soon, target_in, state.drive, dt_s) else 0
        fresh = abs(target_in - state.target_in) > self.again_in
        lost = math.copysign(target_in - soon.w, (target_in - soon.w) * miss_in) > self.again_in
        if (fresh or lost) and abs(miss_in) > self.again_in and not self._at_stop(target_in):
            return 1 if miss_in > 0.0 else -1
        return 0

    def _at_stop(self, target_in: float) -> bool:
        return not 0.004 < target_in < self.design.travel - 0.004

    def _is_early(self, soon: Inside, target_in: float, drive: int, dt_s: float) -> bool:
        """Whether braking a tick later would still land nearer to the target."""
        now_in = self._landing(soon, target_in, drive, dt_s)
        later = self._observer.ahead(soon, self._command_psi(soon, self._drive_psi(soon, target_in, drive)), dt_s)
        later_in = self._landing(later, target_in, drive, dt_s)
        return abs(later_in - target_in) < abs(now_in - target_in)

    def _landing(self, inside: Inside, target_in: float, drive: int, dt_s: float) -> float:
        """Where the stem is when braking from here has brought the play output to the target [in]."""
        brake_psi = self._edge_psi(inside, target_in, -drive)
        for _ in range(12):
            if drive * (inside.w - target_in) <= 0.001:
                break
            inside = self._observer.ahead(inside, self._command_psi(inside, brake_psi), dt_s)
        return inside.x

    def _edge_psi(self, inside: Inside, position_in: float, side: int) -> float:
        return (inside.a1 if side > 0 else inside.a2) + position_in / self.design.compliance

    def _drive_psi(self, inside: Inside, target_in: float, drive: int) -> float:
        speed = min(self.design.rate_limit, abs(target_in - inside.x) / self.approach_s)
        return self._edge_psi(inside, inside.x + drive * speed * self.design.tau_s, drive)

    def _settle_psi(self, inside: Inside, target_in: float, aim_psi: float) -> float:
        if self._at_stop(target_in):
            return self._stop_psi(inside, target_in)
        miss_in = target_in - inside.w
        closing, opening = self._observer.contact(inside)
        side = 1 if miss_in > 0.0 else -1
        tolerance_in = self.same_in if (closing if side > 0 else opening) else self.back_in
        return self._edge_psi(inside, target_in, side) if abs(miss_in) > tolerance_in else aim_psi

    def _stop_psi(self, inside: Inside, target_in: float) -> float:
        """Well beyond the edge: an end stop forgives."""
        closed = target_in > 0.5 * self.design.travel
        reach_in = self.design.rate_limit * self.design.tau_s
        return self._edge_psi(inside, target_in + math.copysign(reach_in, 1 if closed else -1), 1 if closed else -1)

    def _command_psi(self, inside: Inside, aim_psi: float) -> float:
        away_psi = aim_psi - inside.p
        return self.clamp(inside.command_for(inside.p + (self.lead if abs(away_psi) > 0.1 else 1.0) * away_psi))


CONTROLLER = Overdrive
