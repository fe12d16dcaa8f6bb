"""The play as a brake: full drive, landing on the opposite edge, then the pressure backs off and nothing moves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from control.controller import Law, Seen
from control.observer import Inside
from control.play_filter import Belief, PlayFilter


@dataclass(frozen=True, slots=True)
class Found:
    """Both edges when they were last known well [psi], and their standard deviations then [psi]."""

    a1: float
    a2: float
    doubt_1: float
    doubt_2: float


@dataclass(frozen=True, slots=True)
class BrakeState:
    """The belief for the next reading; `drive` is +1 closing, -1 opening, 0 settling; the aim [psi], and for how long
    it has not changed [s]; whether the valve sticks; how often it has been turned back or stroked for this target."""

    belief: Belief
    target_in: float
    aim_psi: float
    drive: int = 0
    quiet_s: float = 0.0
    found: Found | None = None
    sticks: bool = False
    turns: int = 0


@dataclass(frozen=True)
class Brake(Law[BrakeState]):
    """Time-optimal moves through the play as it is learned, and a pressure in the middle of the gap when all is done.

    Driving: the play output is put so far ahead that the stem runs at its rate limit, and is brought back through the
    deadband in time; the last pressure before braking is chosen so that the stem lands on the target between two ticks.
    Settling: a miss of the play output is answered when it is larger than `tolerance_in` and `sure` standard deviations
    of what is known; then the pressure retreats by `retreat_psi` from the edge, where noise, drift of the converter and
    small leaks move nothing. Sticking: where the pressure has gone `grip_psi` and `surely` standard deviations beyond
    an edge and nothing has moved, small pushes are given up; from then on every correction is a stroke of `stroke_psi`
    beyond the edge and back, which slides from start to end. Each time of turning back makes it more tolerant.
    """

    tolerance_in: float = 0.0007
    sure: float = 1.25
    band_in: float = 0.0028
    again_in: float = 0.005
    short_in: float = 0.0005
    patience_s: float = 3.0
    retreat_psi: float = 0.4
    grip_psi: float = 0.03
    surely: float = 2.5
    stroke_psi: float = 0.45

    def start(self, seen: Seen, target_in: float) -> BrakeState:
        return BrakeState(self._filter.start(seen), seen.position_in, seen.commanded_psi)

    def law(self, state: BrakeState, seen: Seen, target_in: float, dt_s: float) -> tuple[BrakeState, float]:
        keep, soon = self._filter.track(state.belief, seen, dt_s)
        fresh = abs(target_in - state.target_in) > 1e-4
        state = self._gripped(replace(state, turns=0) if fresh else state, soon)
        drive, turns = self._begun(state, soon, target_in, fresh), state.turns
        found, aim_psi = state.found, state.aim_psi
        if drive:
            turns += 1 if not (state.drive or fresh) else 0
            least = state.sticks and not state.drive
            aim_psi, drive = self._driven(soon, target_in, drive, dt_s, least)
            found = None if drive else _found(soon)
        elif self._is_stop(target_in):
            aim_psi, found = self._stop_psi(soon, target_in, aim_psi), None
        else:
            side = 0 if state.sticks else self._pushed(soon, target_in, turns)
            turns += 1 if side and not self._touches(soon, side) else 0
            aim_psi = self._push_psi(soon, target_in, side) if side else self._parked(state, soon)
        quiet_s = state.quiet_s + dt_s if aim_psi == state.aim_psi else 0.0
        after = BrakeState(keep, target_in, aim_psi, drive, quiet_s, found, state.sticks, turns)
        return after, self._command_psi(soon.inside, aim_psi, dt_s)

    @property
    def _filter(self) -> PlayFilter:
        return PlayFilter(self.design)

    def _is_stop(self, target_in: float) -> bool:
        return not 0.004 < target_in < self.design.travel - 0.004

    def _touches(self, soon: Belief, side: int) -> bool:
        return self._filter.observer(soon).contact(soon.inside)[0 if side > 0 else 1]

    def _allowed_in(self, soon: Belief, turns: int) -> float:
        return self.tolerance_in * min(1.0 + 0.25 * max(turns - 2, 0), 1.6) + self.sure * soon.doubt_in

    def _gripped(self, state: BrakeState, soon: Belief) -> BrakeState:
        """Notices that the valve sticks, and notes the edges whenever they are known better than before."""
        if state.sticks or state.drive or state.found is None:
            return state
        rest_psi, was = soon.inside.w / soon.compliance, state.found
        closing_psi = soon.inside.p - was.a1 - rest_psi - self.surely * was.doubt_1
        opening_psi = was.a2 + rest_psi - soon.inside.p - self.surely * was.doubt_2
        if max(closing_psi, opening_psi) > self.grip_psi:
            return replace(state, sticks=True)
        now = _found(soon)
        better = now.doubt_1 + now.doubt_2 < 0.5 * (was.doubt_1 + was.doubt_2)
        return replace(state, found=now) if better and state.quiet_s > 1.5 else state

    def _begun(self, state: BrakeState, soon: Belief, target_in: float, fresh: bool) -> int:
        """The way to drive, 0 for none: to a new target, back to one that was missed, or as a stroke."""
        if self._is_stop(target_in) or state.drive:
            return 0 if self._is_stop(target_in) else state.drive
        miss_in, off_in = target_in - soon.inside.x, target_in - soon.inside.w
        way = 1 if miss_in > 0.0 else -1
        if fresh:
            return way if abs(miss_in) > self.band_in else 0
        if abs(miss_in) > self.again_in and way * off_in > self.again_in + 2.0 * soon.doubt_in:
            return way
        stroke = state.sticks and state.quiet_s > self.patience_s
        return _sign(off_in) if stroke and abs(off_in) > self._allowed_in(soon, state.turns) else 0

    def _driven(self, soon: Belief, target_in: float, drive: int, dt_s: float, stroke: bool) -> tuple[float, int]:
        """The aim of the next tick [psi], and whether the drive goes on after it."""
        x, edge_in = soon.inside.x, min(self.short_in + 0.7 * soon.edge_doubt_in(-drive), 0.002)
        brake_psi = soon.edge_psi(target_in + drive * edge_in, -drive)
        full_psi = soon.edge_psi(x + 1.1 * drive * self.design.rate_limit * self.design.tau_s, drive)

        def beyond_in(aim_psi: float) -> float:
            return drive * (self._landing_in(soon, aim_psi, brake_psi, target_in, drive, dt_s) - target_in)

        if stroke:
            least_psi = soon.edge_psi(soon.inside.w, drive) + drive * self.stroke_psi
            if beyond_in(least_psi) >= 0.0:
                return least_psi, drive
        elif beyond_in(brake_psi) >= -0.0003:
            return brake_psi, 0
        if beyond_in(full_psi) <= 0.0:
            return full_psi, drive
        low_psi, high_psi = brake_psi, full_psi
        for _ in range(8):
            middle_psi = 0.5 * (low_psi + high_psi)
            low_psi, high_psi = (middle_psi, high_psi) if beyond_in(middle_psi) < 0.0 else (low_psi, middle_psi)
        return 0.5 * (low_psi + high_psi), drive

    def _landing_in(
        self, soon: Belief, aim_psi: float, brake_psi: float, target_in: float, drive: int, dt_s: float
    ) -> float:
        """Where the stem is when the play output is back at the target, with one more tick at `aim_psi` [in]."""
        observer = self._filter.observer(soon)
        inside = observer.ahead(soon.inside, self._command_psi(soon.inside, aim_psi, dt_s), dt_s)
        for _ in range(12):
            if drive * (inside.w - target_in) <= 0.003:
                break
            inside = observer.ahead(inside, self._command_psi(inside, brake_psi, dt_s), dt_s)
        return inside.x

    def _pushed(self, soon: Belief, target_in: float, turns: int) -> int:
        miss_in = target_in - soon.inside.w
        return _sign(miss_in) if abs(miss_in) > self._allowed_in(soon, turns) else 0

    def _push_psi(self, soon: Belief, target_in: float, side: int) -> float:
        """To the edge; through the deadband a little short of it, because pushing on is cheaper than turning back."""
        short_in = 0.0 if self._touches(soon, side) else self.short_in + min(soon.edge_doubt_in(side), 0.01)
        return soon.edge_psi(target_in - side * short_in, side)

    def _parked(self, state: BrakeState, soon: Belief) -> float:
        """Off the edge where the pressure rests, at most into the middle of the gap; where it is, before patience."""
        if state.quiet_s <= self.patience_s:
            return state.aim_psi
        low_psi, high_psi = (soon.edge_psi(soon.inside.w, side) for side in (-1, 1))
        room_psi = min(self.retreat_psi, 0.5 * (high_psi - low_psi))
        if soon.inside.p > high_psi - 0.5 * room_psi:
            return high_psi - room_psi
        return low_psi + room_psi if soon.inside.p < low_psi + 0.5 * room_psi else state.aim_psi

    def _stop_psi(self, soon: Belief, target_in: float, aim_psi: float) -> float:
        """Well beyond the edge, because an end stop forgives; left alone once the stem is there."""
        side = 1 if target_in > 0.5 * self.design.travel else -1
        stop_in = self.design.travel if side > 0 else 0.0
        if abs(soon.inside.x - stop_in) < self.again_in and side * (aim_psi - soon.edge_psi(stop_in, side)) > 0.3:
            return aim_psi
        return soon.edge_psi(stop_in + side * self.design.rate_limit * self.design.tau_s, side)

    def _command_psi(self, inside: Inside, aim_psi: float, dt_s: float) -> float:
        """The command that brings the pressure to the aim within a tick, if the supply can."""
        away_psi, tau_s = aim_psi - inside.p, self.design.ep_tau_s
        lead = min(1.0 / (1.0 - math.exp(-dt_s / tau_s)), 3.5) if tau_s > 0.0 else 1.0
        return self.clamp(inside.command_for(inside.p + (lead if abs(away_psi) > 0.05 else 1.0) * away_psi))


def _found(soon: Belief) -> Found:
    doubts = (soon.edge_doubt_in(side) / soon.compliance for side in (1, -1))
    return Found(soon.inside.a1, soon.inside.a2, *doubts)


def _sign(value: float) -> int:
    return 1 if value > 0.0 else -1


CONTROLLER = Brake
