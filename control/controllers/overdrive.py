"""Fastest safe move: drive the play output beyond the target, brake through the deadband, land on the target."""

from __future__ import annotations

import math
from dataclasses import dataclass

from control.controller import Law, Seen
from control.observer import Inside, Observer


@dataclass(frozen=True, slots=True)
class OverdriveState:
    """The estimate of the inside at the next instant; `drive` is +1 closing, -1 opening, 0 settling; the aim [psi];
    for how long it has not changed [s]; the side that the play output was last pushed to while settling, and how often
    it has been turned back for this target."""

    inside: Inside
    drive: int
    target_in: float
    aim_psi: float
    quiet_s: float = 0.0
    side: int = 0
    turns: int = 0


@dataclass(frozen=True)
class Overdrive(Law[OverdriveState]):
    """If-Then on the *predicted end position* (the play output w) instead of on the measured one, with overdrive.

    Driving: w is put ahead of the stem, so far that the stem runs at its rate limit (or covers the distance in
    `approach_s`). It brakes when braking now lands nearer to the target than braking one tick later. Settling: where
    w is off by more than the tolerance, the pressure goes to the edge that moves it; otherwise nothing moves, so that
    there is no limit cycle. Pressure readings and edges are learned on the way (observer).

    `lead` sharpens the converter's response; `again_in` [in] is the miss that is worth a new drive; `same_in`,
    `back_in` are the tolerances for pushing on and for turning back through the deadband, and `short_in` is how
    much less than the miss is asked for when turning back.
    """

    approach_s: float = 0.5
    lead: float = 2.0
    again_in: float = 0.005
    same_in: float = 0.0005
    back_in: float = 0.001
    short_in: float = 0.0006
    patience_s: float = 4.0
    tolerance: float = 0.3
    omega: float = 1.6

    def start(self, seen: Seen, target_in: float) -> OverdriveState:
        return OverdriveState(self._observer.start(seen), 0, seen.position_in, seen.commanded_psi)

    def law(self, state: OverdriveState, seen: Seen, target_in: float, dt_s: float) -> tuple[OverdriveState, float]:
        observer = self._observer
        keep, soon = observer.track(state.inside, seen, dt_s, max(self.omega / (1.0 + 0.5 * state.quiet_s), 0.25))
        drive = self._drive(state, soon, target_in, dt_s)
        same = abs(target_in - state.target_in) < self.same_in
        side, turns = state.side, state.turns if same else 0
        if drive:
            side, aim_psi = 0, self._drive_psi(soon, target_in, drive)
        elif self._at_stop(target_in):
            aim_psi = self._stop_psi(soon, target_in, state.aim_psi)
        else:
            pushed = self._push(soon, target_in, turns, state.quiet_s)
            turns += 1 if side * pushed < 0 else 0
            side = pushed or side
            aim_psi = self._approach_psi(soon, target_in, pushed) if pushed else state.aim_psi
        quiet_s = state.quiet_s + dt_s if aim_psi == state.aim_psi else 0.0
        return OverdriveState(keep, drive, target_in, aim_psi, quiet_s, side, turns), self._command_psi(soon, aim_psi)

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

    def _approach_psi(self, inside: Inside, target_in: float, side: int) -> float:
        """Towards the target; through the deadband a little short of it, because pushing on is cheaper than back."""
        short_in = 0.0 if self._observer.contact(inside)[0 if side > 0 else 1] else self.short_in
        return self._edge_psi(inside, target_in - side * short_in, side)

    def _drive_psi(self, inside: Inside, target_in: float, drive: int) -> float:
        speed = min(self.design.rate_limit, abs(target_in - inside.x) / self.approach_s)
        return self._edge_psi(inside, inside.x + drive * speed * self.design.tau_s, drive)

    def _push(self, inside: Inside, target_in: float, turns: int, quiet_s: float) -> int:
        """The side on which the play output has to be pushed to reach the target; 0 where it is near enough.

        A large miss is answered at once, a small one only when the estimate has had `patience_s` to calm down (half of
        that to push on). Every time that it had to be turned back makes it more tolerant: where friction or a dead time
        defeats small corrections, an error that stays is better than hunting.
        """
        miss_in = target_in - inside.w
        closing, opening = self._observer.contact(inside)
        side = 1 if miss_in > 0.0 else -1
        in_contact = closing if side > 0 else opening
        allowed_in = self.same_in if in_contact else self.back_in * (1.0 + self.tolerance * max(turns - 3, 0))
        if quiet_s < (0.5 if in_contact else 1.0) * self.patience_s:
            allowed_in *= 4.0
        return side if abs(miss_in) > allowed_in else 0

    def _stop_psi(self, inside: Inside, target_in: float, aim_psi: float) -> float:
        """Well beyond the edge, because an end stop forgives; left alone once it is there."""
        side = 1 if target_in > 0.5 * self.design.travel else -1
        stop_in = self.design.travel if side > 0 else 0.0
        if abs(inside.x - stop_in) < self.again_in and side * (aim_psi - self._edge_psi(inside, stop_in, side)) > 0.3:
            return aim_psi
        return self._edge_psi(inside, stop_in + side * self.design.rate_limit * self.design.tau_s, side)

    def _command_psi(self, inside: Inside, aim_psi: float) -> float:
        away_psi = aim_psi - inside.p
        return self.clamp(inside.command_for(inside.p + (self.lead if abs(away_psi) > 0.1 else 1.0) * away_psi))


CONTROLLER = Overdrive
