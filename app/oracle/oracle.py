"""A controller that is told everything but the future: the bench forbids no more than what this one misses.

It knows the plant's equations, all its true numbers, its true edges and the state it starts in. What it does not know
are the random numbers; it sees the gauges that every controller sees. It moves by a push of the length that its model
of the plant says, with a stroke before it where the plate would stick or jump, parks the pressure in the middle of the
gap, averages, and pushes again only if it is likelier to be outside the tolerance than it would be after another push.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from app.oracle.doubt import Doubt, outside
from app.oracle.ghost import Ghost
from control.metrics import GOAL_PERCENT
from control.scenarios import TRAVEL_IN, Scenario
from hal.sample import Sample

TOLERANCE_IN = 0.01 * GOAL_PERCENT * TRAVEL_IN
PUSH, PARK = 20, 30  # ticks of a push, after which the pressure is where it goes; and to look where it ends
REACHED_IN = 2e-5  # a push that ends further from its target cannot reach it
LOOK_S = 8.0  # three time constants of the stem, before a miss is judged
NEVER_MIND = 1e-4  # a chance that is not worth a push
STOP_IN, STOP_PSI = 0.001, 1.5  # so near to an end stop it is the target, and the pressure goes so far beyond
ROOM_IN = 0.02  # of a stroke, beyond what the plate jumps
RESTART = 0.02  # of travel: a target that has gone so far on is a new one


@dataclass(slots=True)
class Knowledge:
    """The ghost and the doubt of it; the commands that are still to go out, then the one for good [psi]; where that
    goes [in]."""

    ghost: Ghost
    doubt: Doubt
    queue: list[float]
    goal_in: float = 0.0
    parked_psi: float = 0.0


@dataclass(frozen=True)
class Oracle:
    """Implements `control.controller.Controller`; its state is changed in place, because a trial is played once."""

    scenario: Scenario

    @property
    def settings(self) -> Mapping[str, float | str]:
        return {}

    def initial(self, sample: Sample, target_in: float) -> Knowledge:
        return Knowledge(Ghost(self.scenario), Doubt(self.scenario.noise), [], 0.0, sample.commanded_psi)

    def step(self, state: Knowledge, sample: Sample, target_in: float, dt_s: float) -> tuple[Knowledge, float]:
        """Plans on the ghost as it will be when the next command goes out."""
        self._look(state, sample, dt_s)
        ghost = state.ghost
        ghost.put(state.doubt.wander_psi)
        before_in = ghost.now("slider")
        ghost.advance(sample.commanded_psi, dt_s)
        state.doubt = self._moved(state, before_in, dt_s)
        (travel_in,) = ghost.numbers("travel")
        target_in = min(target_in / ghost.gain, travel_in)
        if self._wants(state, target_in):
            self._folded(state)
            state.queue, state.goal_in = self._plan(ghost, target_in, dt_s), target_in
            state.parked_psi = state.queue.pop()
        return state, state.queue.pop(0) if state.queue else state.parked_psi

    def _look(self, state: Knowledge, sample: Sample, dt_s: float) -> None:
        """The ghost is at the instant of the sample."""
        ghost, doubt = state.ghost, state.doubt
        assert sample.pressure is not None
        off_psi = sample.pressure.value - ghost.now("pressure") + ghost.now("wander")
        off_in = sample.position.value - ghost.gain * ghost.now("stem")
        state.doubt = doubt.read(off_psi, off_in, ghost.gain * self._share(state), dt_s)

    def _share(self, state: Knowledge) -> float:
        (tau_s,) = state.ghost.numbers("tau")
        return 1.0 - math.exp(-state.doubt.since_s / tau_s)

    def _moved(self, state: Knowledge, before_in: float, dt_s: float) -> Doubt:
        ghost, doubt = state.ghost, state.doubt.later(dt_s)
        compliance, tau_s, rate, travel_in = ghost.numbers("compliance", "tau", "rate_limit", "travel")
        plate_in = ghost.now("slider")
        if abs(plate_in - before_in) > 1e-9:
            stopped = plate_in <= 1e-9 or plate_in >= travel_in - 1e-9
            return doubt.on_stop() if stopped else doubt.pushed(compliance)
        if abs(plate_in - ghost.now("stem")) > rate * tau_s:  # it runs at its limit and shows nothing yet
            return Doubt(doubt.noise, *(doubt.wander_psi, doubt.off_in, doubt.wander_var, doubt.both, doubt.off_var))
        return doubt

    def _wants(self, state: Knowledge, target_in: float) -> bool:
        """A new target, or one that is likelier missed than it would be after another push."""
        ghost, doubt = state.ghost, state.doubt
        compliance, travel_in = ghost.numbers("compliance", "travel")
        new_in = abs(target_in - state.goal_in)
        if new_in > 1e-6 and (not state.queue or new_in > RESTART * travel_in):
            return True
        if state.queue or doubt.since_s < LOOK_S or not STOP_IN < target_in < travel_in - STOP_IN:
            return False
        miss_in = target_in - ghost.now("slider") - doubt.off_in
        now = outside(miss_in, doubt.off_sd_in, TOLERANCE_IN)
        return now > max(outside(0.0, compliance * math.sqrt(doubt.wander_var), TOLERANCE_IN), NEVER_MIND)

    def _folded(self, state: Knowledge) -> None:
        """What is known of the plate goes into the ghost, before the next move."""
        doubt = state.doubt
        state.ghost.put(doubt.wander_psi, doubt.off_in, self._share(state) * doubt.off_in)
        state.doubt = Doubt(doubt.noise, doubt.wander_psi, 0.0, doubt.wander_var, doubt.both, doubt.off_var, 0.0)

    def _plan(self, ghost: Ghost, target_in: float, dt_s: float) -> list[float]:
        """The commands [psi] of the next ticks, the last one for good."""
        a1, a2, compliance, travel_in, grip_psi = ghost.numbers("a1", "a2", "compliance", "travel", "stiction")
        rest_psi = target_in / compliance
        if not STOP_IN < target_in < travel_in - STOP_IN:
            return [a1 + rest_psi + STOP_PSI if target_in > 0.5 * travel_in else max(a2 - STOP_PSI, 0.0)]
        park_psi = 0.5 * (a1 + a2) + rest_psi
        way = 1 if target_in > ghost.now("slider") else -1
        push_psi, ends_in = self._push(ghost, [], park_psi, target_in, way, dt_s)
        if abs(ends_in - target_in) < REACHED_IN:
            return [push_psi] * PUSH + [park_psi]
        room_in = 1.2 * grip_psi * compliance + ROOM_IN
        way = -way if 0.0 < target_in - way * room_in < travel_in else way
        over_psi = (a2 if way > 0 else a1) + (target_in - way * room_in) / compliance
        stroke = [(min(max(over_psi, 0.0), 20.0), PUSH)]
        push_psi, _ = self._push(ghost, stroke, park_psi, target_in, way, dt_s)
        return [stroke[0][0]] * PUSH + [push_psi] * PUSH + [park_psi]

    def _push(
        self, ghost: Ghost, first: list[tuple[float, int]], park_psi: float, target_in: float, way: int, dt_s: float
    ) -> tuple[float, float]:
        """The command of a push that ends at the target, or as near as it can; and where it ends [in]."""
        near_psi, far_psi = park_psi, 20.0 if way > 0 else 0.0
        ends_in = ghost.now("slider")
        for _ in range(24):
            push_psi = 0.5 * (near_psi + far_psi)
            ends_in = ghost.lands_in([*first, (push_psi, PUSH), (park_psi, PARK)], dt_s)
            if way * (ends_in - target_in) < 0.0:
                near_psi = push_psi
            else:
                far_psi = push_psi
        return push_psi, ends_in
