"""The play as a brake: full drive, landing on the opposite edge, then the pressure backs off and nothing moves."""

from __future__ import annotations

from dataclasses import dataclass, replace

from control.aims import parked_psi, stop_psi
from control.brake_state import BrakeState
from control.controller import Law, Seen
from control.detour import FURTHER, TIMES, gains, hardly_known, over_psi
from control.exact import sign
from control.grip import Grip
from control.lead import command_toward
from control.observer import Inside
from control.play_filter import Belief, PlayFilter
from control.resting import Resting, in_vain, is_beyond, way_of_stroke

Now = tuple[float, float]  # the command in force [psi], and how long a tick is [s]
GIVEN_UP = 99  # turns after which a target is left alone
LEFT = 1.5  # times as large as a new one a miss has to be that was left alone, to be pushed through the gap


@dataclass(frozen=True)
class Brake(Law[BrakeState]):
    """Time-optimal moves through the play as it is learned, and a pressure in the middle of the gap when all is done.

    Driving: the play output is put so far ahead that the stem runs at its rate limit, and is brought back through the
    deadband in time; the last pressure before braking is chosen so that the stem lands on the target between two ticks.
    Settling: a miss of the play output is answered when it is larger than `tolerance_in` and `sure` standard deviations
    of what is known; then the pressure retreats by `retreat_psi` from the edge, where noise, drift of the converter and
    small leaks move nothing. Sticking: where the pressure has gone `grip_psi` and `surely` standard deviations beyond
    an edge and nothing has moved, or on and on without the play output coming along, small pushes are given up, and
    what they seemed to teach is forgotten; from then on every correction is a stroke of `stroke_psi` beyond the edge
    and back, which slides from start to end, after `look_s` of rest, and turns round only `free_psi` beyond the edge,
    where the plate has let go; at most `strokes` per target, and none that takes longer than `stroke_s`; what was left
    alone for `while_s` stays, unless it is larger than a new miss may be. Each turn makes it more tolerant. Detours: an
    edge that is hardly known does not push; the plate goes beyond it and comes back by the other, `TIMES` per target.
    `slew_psi_per_s`: as fast as the bench lets commands change.
    """

    tolerance_in: float = 0.0007
    sure: float = 1.0
    band_in: float = 0.0028
    again_in: float = 0.005
    short_in: float = 0.0005
    patience_s: float = 3.0
    look_s: float = 2.2
    retreat_psi: float = 0.4
    grip_psi: float = 0.04
    surely: float = 2.5
    stroke_psi: float = 0.45
    strokes: float = 6.0
    stroke_s: float = 1.5
    free_psi: float = 0.33
    while_s: float = 6.0
    slew_psi_per_s: float = 1e6

    def start(self, seen: Seen, target_in: float) -> BrakeState:
        return BrakeState(self._filter.start(seen), seen.position_in, seen.commanded_psi)

    def law(self, state: BrakeState, seen: Seen, target_in: float, dt_s: float) -> tuple[BrakeState, float]:
        keep, soon = self._filter.track(state.belief, seen, dt_s, state.late)
        fresh, before_psi = abs(target_in - state.target_in) > 1e-4, state.aim_psi
        state = replace(state.at(target_in) if fresh else state, belief=keep, target_in=target_in)
        rest = state.rest.read(*(place_in - target_in for place_in in (seen.position_in, soon.inside.x, soon.inside.w)))
        grip = state.grip.read(seen, soon, (target_in, before_psi), self.design, dt_s)
        state, soon = self._gripped(replace(state, rest=Resting() if state.drive else rest, grip=grip), soon)
        late = state.late.read(self._filter.observer(soon), seen.position_in, seen.pressure_psi, dt_s)
        drive = self._begun(state, soon, fresh)
        if not drive and not fresh and self._worth_a_detour(state, soon):
            drive, far_psi = sign(target_in - soon.inside.w), over_psi(soon, target_in - soon.inside.w)
            state = replace(state, over_psi=far_psi, detours=state.detours + 1, turns=0, pushes=0)
        if drive and not state.drive:
            late = late.begun(drive, soon.inside, soon.edge_psi(soon.inside.x, drive), target_in, seen.pressure_psi)
        state = replace(state, late=late)
        after = (
            self._driving(state, soon, drive, fresh, (seen.commanded_psi, dt_s))
            if drive
            else self._settling(state, soon)
        )
        quiet_s = state.quiet_s + dt_s if after.aim_psi == before_psi else 0.0
        driven_s = state.driven_s + dt_s if after.drive else 0.0
        grip = after.grip.driven(after.drive, after.drive * (soon.inside.w - target_in))
        calm = after.turns > 2 and not (after.drive or after.sticks)  # beyond the aim, then, costs more than it gains
        command_psi = self._command_psi(soon.inside, after.aim_psi, seen.commanded_psi, dt_s, calm)
        return replace(after, quiet_s=quiet_s, driven_s=driven_s, grip=grip), command_psi

    def _driving(self, state: BrakeState, soon: Belief, drive: int, fresh: bool, now: Now) -> BrakeState:
        turns = state.turns + (0 if state.drive or fresh else 1)
        stroke = state.sticks and turns > 0
        from_in = state.from_in if state.drive else soon.inside.x
        gone_psi = drive * (soon.inside.p - soon.edge_psi(from_in, drive))
        free_psi = self.free_psi if stroke else state.over_psi if state.driven_s < self.stroke_s else 0.0
        held = free_psi > 0.0 and (not state.drive or gone_psi < free_psi)
        way, (aim_psi, drive) = drive, self._driven(soon, state, drive, now, held)
        after = replace(state, aim_psi=aim_psi, drive=drive, turns=turns, pushing=False, from_in=from_in)
        if state.over_psi and not drive:  # the other edge brings the plate back now: whether it sticks is watched anew
            after = replace(after, over_psi=0.0, grip=Grip(side=-way))
        still = abs(soon.inside.x - from_in) < 2.0 * self.again_in
        if stroke and state.driven_s > self.stroke_s and still:  # what it seemed to teach is forgotten
            belief = state.belief.with_numbers(state.found) if state.found else state.belief
            return replace(after, drive=0, turns=GIVEN_UP, belief=belief)
        return replace(after, found=soon if not drive else state.found if stroke else None, rest=Resting())

    def _settling(self, state: BrakeState, soon: Belief) -> BrakeState:
        target_in, pushes, was_pushing = state.target_in, state.pushes, state.pushing
        state = replace(state, drive=0, pushing=False)
        if self._is_stop(target_in):
            d, stop_in = self.design, self.design.travel if target_in > 0.5 * self.design.travel else 0.0
            aim_psi = stop_psi(soon, stop_in, state.aim_psi, self.again_in, d.rate_limit * d.tau_s)
            return replace(state, aim_psi=aim_psi, found=None)
        waits = state.sticks or self._wants_a_detour(state, soon)
        side = 0 if waits else self._pushed(state, soon)
        if not side:
            rests = state.quiet_s > self.patience_s
            return replace(state, aim_psi=parked_psi(soon, state.aim_psi, self.retreat_psi) if rests else state.aim_psi)
        pushes = side if side * pushes < 0 else pushes + side * (not was_pushing)
        turns = state.turns + (0 if self._touches(soon, side) else 1)
        mark = state.mark if abs(pushes) > 2 else soon.mark(side)
        aim_psi = self._push_psi(soon, target_in, side, abs(pushes))
        return replace(state, aim_psi=aim_psi, pushing=True, pushes=pushes, turns=turns, mark=mark)

    @property
    def _filter(self) -> PlayFilter:
        return PlayFilter(self.design)

    def _is_stop(self, target_in: float) -> bool:
        return not 0.004 < target_in < self.design.travel - 0.004

    def _touches(self, soon: Belief, side: int) -> bool:
        return self._filter.observer(soon).contact(soon.inside)[0 if side > 0 else 1]

    def _allowed_in(self, soon: Belief, turns: int) -> float:
        return (self.tolerance_in + self.sure * soon.doubt_in) * min(1.0 + 0.2 * max(turns - 2, 0), 1.6)

    def _gripped(self, state: BrakeState, soon: Belief) -> tuple[BrakeState, Belief]:
        """Notices that the valve sticks, and forgets what was learned by pushing in vain; notes the edges whenever they
        are known better than before."""
        if state.sticks or state.drive or state.found is None:
            return state, soon
        was, late = state.found, state.late.known_s > 0.0
        grip = Grip() if late or soon.inside.line.ticks else state.grip  # between ticks nothing is seen
        shown = state.rest.swung(soon.noise_in) or state.rest.stays(soon, was, state.target_in, self.surely)
        vain = in_vain(soon, state.mark, state.pushes, late) or is_beyond(soon, was, self.grip_psi, self.surely)
        if grip.stays(soon) or shown or vain:
            quiet_s = self.look_s + 0.1 if grip.stays(soon) else state.quiet_s  # that has been looked at
            was, belief, soon = grip.known(was, state.target_in, state.belief, soon)
            return replace(state, sticks=True, turns=0, belief=belief, found=was, grip=Grip(), quiet_s=quiet_s), soon
        now_psi, was_psi = (b.edge_doubt_psi(1) + b.edge_doubt_psi(-1) for b in (soon, was))
        calm = state.quiet_s > 1.5 and abs(state.pushes) < 2
        return (replace(state, found=soon) if now_psi < 0.5 * was_psi and calm else state), soon

    def _begun(self, state: BrakeState, soon: Belief, fresh: bool) -> int:
        """The way to drive, 0 for none: to a new target, back to one that was missed, or as a stroke."""
        target_in = state.target_in
        if self._is_stop(target_in) or state.drive:
            return 0 if self._is_stop(target_in) else state.drive
        miss_in, off_in = target_in - soon.inside.x, target_in - soon.inside.w
        way = sign(miss_in)
        if fresh:
            return way if abs(miss_in) > self.band_in else 0
        again_in = self.again_in * (1.0 if state.sticks else max(0.125 * state.turns, 1.0))
        far = abs(miss_in) > again_in and way * off_in > again_in + 2.0 * soon.doubt_in
        if not state.sticks:
            return way if far and state.turns < GIVEN_UP else 0
        lands = abs(state.aim_psi - soon.inside.p) > 0.2
        strokes = state.turns < self.strokes and self._beyond_doubt(state, soon, off_in)
        if (far and not lands and state.turns < GIVEN_UP) or strokes:
            return way_of_stroke(soon, off_in, soon.compliance * self.stroke_psi)
        return 0

    def _wants_a_detour(self, state: BrakeState, soon: Belief) -> bool:
        """Whether a miss, if there is one, is not for a push through the gap: the first times for each target."""
        miss_in = state.target_in - soon.inside.w
        not_now = state.sticks or state.late.known_s > 0.0 or self._touches(soon, sign(miss_in))
        return state.detours < TIMES and not not_now and hardly_known(soon, miss_in)

    def _worth_a_detour(self, state: BrakeState, soon: Belief) -> bool:
        miss_in = state.target_in - soon.inside.w
        settles = not (state.drive or self._is_stop(state.target_in)) and self._beyond_doubt(state, soon, miss_in)
        return settles and self._wants_a_detour(state, soon) and gains(soon, miss_in)

    def _beyond_doubt(self, state: BrakeState, soon: Belief, off_in: float) -> bool:
        """Whether a miss is worth a stroke: beyond doubt and, after a while, larger than what was left alone."""
        enough_in = (1.5 if state.quiet_s < self.while_s else 2.2) * self.tolerance_in + 2.0 * soon.doubt_in
        return state.quiet_s > self.look_s and abs(off_in) > enough_in

    def _driven(self, soon: Belief, state: BrakeState, drive: int, now: Now, stroke: bool) -> tuple[float, int]:
        """The aim of the next tick [psi], and whether the drive goes on after it. It brakes a little short, because
        pushing on is cheaper than turning back; a valve that sticks cannot be pushed on."""
        x, target_in = soon.inside.x, state.target_in
        edge_in = 0.0 if state.sticks else min(self.short_in + 0.7 * soon.edge_doubt_in(-drive), 0.002)
        brake_psi = soon.edge_psi(target_in + drive * edge_in, -drive)
        full_psi = soon.edge_psi(x + 1.1 * drive * self.design.rate_limit * self.design.tau_s, drive)

        def beyond_in(aim_psi: float) -> float:
            return drive * (self._landing_in(soon, aim_psi, brake_psi, target_in, drive, now) - target_in)

        if stroke:
            beyond_psi = FURTHER * state.over_psi or self.stroke_psi
            least_psi = soon.edge_psi(soon.inside.w, drive) + drive * beyond_psi
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
        self, soon: Belief, aim_psi: float, brake_psi: float, target_in: float, drive: int, now: Now
    ) -> float:
        """Where the stem is when the play output is back at the target, with one more tick at `aim_psi` [in]."""
        observer, (command_psi, dt_s) = self._filter.observer(soon), now
        command_psi = self._command_psi(soon.inside, aim_psi, command_psi, dt_s)
        inside = observer.ahead(soon.inside, command_psi, dt_s)
        for _ in range(12):
            if drive * (inside.w - target_in) <= 0.003:
                break
            command_psi = self._command_psi(inside, brake_psi, command_psi, dt_s)
            inside = observer.ahead(inside, command_psi, dt_s)
        return inside.x

    def _pushed(self, state: BrakeState, soon: Belief) -> int:
        """The side of the edge that should push, 0 for none. Through the gap, what was left alone for a while after a
        detour has to be worth more than a new miss."""
        miss_in = state.target_in - soon.inside.w
        side = sign(miss_in)
        left = LEFT if state.detours and state.quiet_s > self.while_s and not self._touches(soon, side) else 1.0
        return side if abs(miss_in) > left * self._allowed_in(soon, state.turns) else 0

    def _push_psi(self, soon: Belief, target_in: float, side: int, count: int) -> float:
        """To the edge; through the deadband a little short of it, because pushing on is cheaper than turning back. What
        has to be pushed the same way again was not at the edge: it gets more than is thought to be missing."""
        if self._touches(soon, side):
            short_in = -min(count - 1, 5) * abs(target_in - soon.inside.w)
        else:
            short_in = self.short_in + min(soon.edge_doubt_in(side), 0.01)
        return soon.edge_psi(target_in - side * short_in, side)

    def _command_psi(self, inside: Inside, aim_psi: float, from_psi: float, dt_s: float, calm: bool = False) -> float:
        limits = (from_psi, self.slew_psi_per_s)
        return self.clamp(command_toward(inside, aim_psi, limits, dt_s, self.design.ep_tau_s, calm=calm))


CONTROLLER = Brake
