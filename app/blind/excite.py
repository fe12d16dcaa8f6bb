"""The test sequence of the blind check: inner reversals, random steps and slow ramps, all of it twice.

About 15 minutes at 10 Hz. The repeat is what the noise is measured from; the random part differs from trial to trial.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from control.plan import Plan, plan_targets

if TYPE_CHECKING:
    from collections.abc import Sequence

    from control.experiment import Experiment
    from control.step import Step
    from logs.recording import FloatArray

PERIOD_S = 0.1
TRAVEL_IN = 0.5625
_TARGETS = 6
_HOLD_S = 25.0


def open_loop(seed: int, repeats: int = 2, share: float = 1.0) -> Plan:
    """The sequence; `seed` draws the random steps, `share` scales how long everything takes (0.5: half as long)."""
    parts = _parts(seed, share)
    once: list[Step] = []
    for part in parts:
        once += part.one_pass()
    return Plan(PERIOD_S, tuple(once) * repeats, parts[0].conditioning_steps())


def _parts(seed: int, share: float) -> list[Experiment]:
    from control.experiments.nested import Nested
    from control.experiments.ramp import Ramp
    from control.experiments.random import RandomSteps

    nested = Nested(loops=3, step=0.5, dwell_s=1.5 * share)
    random = RandomSteps(seed=seed, count=12, dwell_min_s=3.0 * share, dwell_max_s=15.0 * share)
    ramp = Ramp(rate_per_s=0.12 / share, dwell_s=5.0)
    return [nested, random, ramp]


def closed_loop(seed: int) -> Plan:
    """Positions to be held under a controller, for the record that the diagnosis never sees."""
    chance = np.random.default_rng([seed, 1])
    targets = chance.uniform(0.05, TRAVEL_IN - 0.05, _TARGETS).round(3)
    return plan_targets([float(x) for x in targets], _HOLD_S, PERIOD_S, TRAVEL_IN)


def commands(plan: Plan, safe: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Time and command of a record of the plan, each of shape (n,): row k has the command that tick k-1 sent."""
    sent = [value for step in (*plan.lead, *plan.steps) for value in _values(step, plan.period_s)]
    command = np.array([safe, *sent[:-1]], dtype=np.float64)
    return np.arange(command.size, dtype=np.float64) * plan.period_s, command


def _values(step: Step, period_s: float) -> Sequence[float]:
    return [step.at(tick * period_s) for tick in range(step.ticks(period_s))]
