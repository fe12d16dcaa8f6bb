"""Model predictive control with the play as a mode: plans are predicted through the play, the best one is begun."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from control.controller import Law, Seen
from control.observer import Inside, Observer
from control.prediction import predict_positions

FloatArray = npt.NDArray[np.float64]
Predictor = Callable[[Observer, Inside, FloatArray, float], FloatArray]


@dataclass(frozen=True, slots=True)
class MpcState:
    """The estimate of the inside at the next instant; the pressure held [psi]; for how long it has been held [s]."""

    inside: Inside
    aim_psi: float
    quiet_s: float


@dataclass(frozen=True)
class Mpc(Law[MpcState]):
    """Every tick a few dozen plans over `horizon_s` are predicted; the first command of the cheapest goes out.

    A plan is: stay; or drive one side of the play ahead for some ticks (or none), then put the pressure on the edge
    that leaves the play output on the target. Cost: mean distance to the target over the horizon plus twice that
    at its end, in inches, plus `move_cost_in` for leaving the pressure that is held: that is what prevents hunting.
    `model` predicts positions for plans; the default is the design model with the edges learned by the observer.
    """

    horizon_s: float = 4.0
    move_cost_in: float = 0.0012
    lead: float = 2.0
    omega: float = 1.5
    model: Predictor = field(default=predict_positions, repr=False)

    def start(self, seen: Seen, target_in: float) -> MpcState:
        return MpcState(Observer(self.design).start(seen), seen.commanded_psi, 0.0)

    def law(self, state: MpcState, seen: Seen, target_in: float, dt_s: float) -> tuple[MpcState, float]:
        observer = Observer(self.design)
        omega = max(self.omega / (1.0 + 0.5 * state.quiet_s), 0.3)
        keep, soon = observer.track(state.inside, seen, dt_s, omega)
        steps = max(int(self.horizon_s / dt_s), 8)
        aims = np.array(list(self._plans(soon, target_in, state.aim_psi, steps)))
        miss = np.abs(self.model(observer, soon, self._commands(soon, aims), dt_s) - target_in)
        cost = miss.mean(axis=1) + 2.0 * miss[:, -1]
        cost[1:] += self.move_cost_in
        best = int(np.argmin(cost))
        quiet_s = state.quiet_s + dt_s if best == 0 else 0.0
        aim_psi = float(aims[best, 0])
        return MpcState(keep, aim_psi, quiet_s), float(self._commands(soon, aims[best : best + 1, :1])[0, 0])

    def _plans(self, inside: Inside, target_in: float, aim_psi: float, steps: int) -> Iterator[FloatArray]:
        """Pressures to aim at, one row of `steps` per plan [psi]; the first plan stays where it is."""
        yield np.full(steps, aim_psi)
        k, side = self.design.compliance, 1 if target_in >= inside.x else -1
        rest = {s: (inside.a1 if s > 0 else inside.a2) + target_in / k for s in (1, -1)}
        for s in (1, -1):
            yield np.full(steps, rest[s])
        for share in (1.05, 0.4, 0.15):
            ahead_in = inside.x + side * share * self.design.rate_limit * self.design.tau_s
            drive_psi = (inside.a1 if side > 0 else inside.a2) + ahead_in / k
            for ticks in (1, 2, 3, 4, 5, 6, 8, 10, 13, 17, 22, 30):
                if ticks < steps:
                    plan = np.full(steps, rest[-side])
                    plan[:ticks] = drive_psi
                    yield plan

    def _commands(self, inside: Inside, aims: FloatArray) -> FloatArray:
        """The commands for aims, sharpened by `lead` against the pressure before them; shape as given [psi]."""
        before = np.concatenate([np.full((aims.shape[0], 1), inside.p), aims[:, :-1]], axis=1)
        away = aims - before
        pressures = before + np.where(np.abs(away) > 0.1, self.lead, 1.0) * away
        commands = (pressures - inside.bias + inside.slope * 9.0) / (1.0 + inside.slope)
        clipped: FloatArray = np.clip(commands, self.min_psi, self.max_psi)
        return clipped


CONTROLLER = Mpc
