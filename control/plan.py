"""A run's steps in order: what comes before it counts (conditioning, approach), and what counts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from control.experiment import Experiment
from control.step import Step, turning_points
from hal.bench import BenchInfo
from hal.errors import BadInput

LEAD = -1  # the step number of everything before the first step


@dataclass(frozen=True, slots=True)
class Plan:
    """`lead` is commanded in open loop first; `steps` follow, numbered from `first`."""

    period_s: float
    steps: tuple[Step, ...]
    lead: tuple[Step, ...] = ()
    first: int = 0

    @property
    def duration_s(self) -> float:
        """The longest time it takes [s]."""
        return sum(step.duration_s for step in (*self.lead, *self.steps))


def plan_experiment(experiment: Experiment, first: int = 0) -> Plan:
    """The plan of an experiment, or of what is left of it from step `first` on.

    What is left starts with a conditioning stroke whatever the experiment says, and with the turning points that the
    valve would still remember.
    Raises: `BadInput` when there is no step `first`.
    """
    steps = experiment.steps()
    if not 0 <= first < len(steps):
        raise BadInput(f"experiment {experiment.kind}: it has steps 0 to {len(steps) - 1}, there is no step {first}")
    lead = experiment.conditioning_steps()
    if first:
        lead = (lead or _stroke(experiment)) + approach(steps[:first], experiment.conditioning_s)
    return Plan(experiment.period_s, steps[first:], lead, first)


def _stroke(experiment: Experiment) -> tuple[Step, ...]:
    low, high, stay_s = experiment.conditioning_low, experiment.conditioning_high, experiment.conditioning_s
    return tuple(Step(level, level, 0.0, stay_s, label="conditioning") for level in (low, high, low))


def approach(done: Sequence[Step], stay_s: float) -> tuple[Step, ...]:
    """Brings a conditioned valve to where `done` had left it: by its turning points, or by a last period of tones."""
    if done[-1].tones:
        return (done[-1],)
    values = [value for step in done for value in (step.start, step.end)]
    return tuple(Step(value, value, 0.0, stay_s, label="approach") for value in turning_points(values))


def plan_targets(targets_in: Sequence[float], hold_s: float, period_s: float, travel_in: float, first: int = 0) -> Plan:
    """Positions [in] to be held one after the other for `hold_s` each, or what is left of them from `first` on.

    Raises: `BadInput` for a target outside the travel, times that cannot be, or no target `first`.
    """
    if not targets_in:
        raise BadInput('there is no target; give positions in inches, for example --targets "0.1,0.4,0.25"')
    for number, target_in in enumerate(targets_in, start=1):
        if not math.isfinite(target_in) or not 0.0 <= target_in <= travel_in * (1.0 + 1e-9):
            raise BadInput(f"target {number} is {target_in:g} in; the valve travels from 0 to {travel_in:g} in")
    if not (math.isfinite(hold_s) and hold_s > 0.0):
        raise BadInput(f"--hold {hold_s:g} s must be above 0")
    if not (math.isfinite(period_s) and period_s > 0.0):
        raise BadInput(f"--period {period_s:g} s must be above 0, and finite")
    if not 0 <= first < len(targets_in):
        raise BadInput(f"there are targets 0 to {len(targets_in) - 1}, there is no target {first}")
    return Plan(period_s, tuple(Step(target, target, 0.0, hold_s) for target in targets_in[first:]), first=first)


def check_bench(plan: Plan, unit: str, low: float, high: float, info: BenchInfo) -> None:
    """Whether this bench can do it, before anything moves. `low` to `high` is the range of commands in `unit`.

    Raises: `BadInput`.
    """
    if unit != info.command_unit:
        raise BadInput(
            f"the commands are in {unit}, bench '{info.name}' takes {info.command_unit}; "
            f"choose a bench that takes {unit}, or set the experiment's unit"
        )
    if low < info.command_min or high > info.command_max:
        raise BadInput(
            f"the experiment commands {low:g} to {high:g} {unit}, "
            f"bench '{info.name}' allows {info.command_min:g} to {info.command_max:g} {unit}"
        )
    if plan.period_s < info.min_period_s:
        raise BadInput(
            f"a period of {plan.period_s:g} s is too short: the wire of bench '{info.name}' needs "
            f"{info.min_period_s:.4g} s for a tick; choose a longer period or a higher baud rate"
        )
