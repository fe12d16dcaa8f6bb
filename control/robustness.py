"""How far a valve may be from its design before a controller hunts: measured on the nonlinear loop, by scanning.

The criterion for a limit cycle is that of `lostmotion compare`. Nothing is assumed to be monotonic: every axis is gone
through from the design outwards, and the first value at which any seed hunts is reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from control.controller import make_controller
from control.design import DesignModel
from control.metrics import GOAL_PERCENT, hold_cycle, last_quarter, settling_s
from control.trial import Opened, run_trial

FloatArray = npt.NDArray[np.float64]
HOLD_S = 60.0
TARGETS_PERCENT = (25.0, 75.0, 50.0)


@dataclass(frozen=True, slots=True)
class Plant:
    """The valve as it is: its numbers, more dead time of the converter, and a delay of the position reading [s]."""

    design: DesignModel
    dead_time_s: float = 0.0
    late_s: float = 0.0


BenchFactory = Callable[[Plant, int], Opened]


@dataclass(frozen=True, slots=True)
class Axis:
    """One way for a valve to be different: values from the design outwards, the value that a bench should bear
    without a limit cycle (the sizes of the scenarios of `compare`), and what a value does."""

    heading: str
    values: tuple[float, ...]
    wanted: float
    change: Callable[[Plant, float], Plant]


@dataclass(frozen=True, slots=True)
class Margin:
    """The first value that hunts and the last one before it that does not; None: the first one hunts already, or none
    hunts. `swing`: how large that first limit cycle is, peak to peak, worst over seeds [percent of travel]."""

    good: float | None
    bad: float | None
    swing: float = 0.0


@dataclass(frozen=True, slots=True)
class Nominal:
    """On the valve as designed, worst over holds and seeds: mean error of the last quarter of a hold and limit cycle
    [percent of travel], time to settle to 0.5 % [s] (infinite where a hold does not)."""

    error: float
    cycle: float
    settling_s: float


@dataclass(frozen=True, slots=True)
class Subject:
    """A controller with the numbers it was given, for the design that it believes in."""

    name: str
    settings: Mapping[str, float]
    design: DesignModel
    tick_s: float = 0.1


def _dead_time(plant: Plant, value: float) -> Plant:
    return replace(plant, dead_time_s=plant.dead_time_s + value)


def _late(plant: Plant, value: float) -> Plant:
    return replace(plant, late_s=plant.late_s + value)


def _compliance(plant: Plant, factor: float) -> Plant:
    return replace(plant, design=replace(plant.design, compliance=factor * plant.design.compliance))


def _deadband(plant: Plant, percent: float) -> Plant:
    d = plant.design
    half = 0.5 * d.deadband * (1.0 + 0.01 * percent)
    return replace(plant, design=replace(d, a1=d.offset + half, a2=d.offset - half))


_DELAYS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0)
AXES: Mapping[str, Axis] = MappingProxyType(
    {
        "dead_time": Axis("dead time\n[s]", _DELAYS, 0.2, _dead_time),
        "late": Axis("late reading\n[s]", _DELAYS, 0.2, _late),
        "softer": Axis("compliance\nx, up", (1.1, 1.2, 1.3, 1.5, 1.75, 2.0, 2.5, 3.0), 1.2, _compliance),
        "stiffer": Axis("compliance\nx, down", (0.9, 0.8, 0.7, 0.6, 0.5, 0.4), 0.8, _compliance),
        "wider": Axis("deadband\nwider [%]", (10.0, 20.0, 30.0, 50.0, 75.0, 100.0), 20.0, _deadband),
        "narrower": Axis("deadband\nnarrower [%]", (-10.0, -20.0, -30.0, -50.0, -75.0, -90.0), -20.0, _deadband),
    }
)


def scan(subject: Subject, axis: Axis, plant: Plant, seeds: Sequence[int], open_bench: BenchFactory) -> Margin:
    """Goes along an axis until a seed hunts."""

    def swing(value: float) -> float:
        changed = axis.change(plant, value)
        return max(largest_cycle(subject, changed, seed, open_bench) for seed in seeds)

    return first_swing(axis.values, swing)


def first_swing(values: Sequence[float], swing: Callable[[float], float]) -> Margin:
    """Goes along `values` to the first at which `swing` [percent of travel] is more than nothing."""
    good = None
    for value in values:
        if (size := swing(value)) > 0.0:
            return Margin(good, value, size)
        good = value
    return Margin(good, None)


def largest_cycle(subject: Subject, plant: Plant, seed: int, open_bench: BenchFactory) -> float:
    """The largest limit cycle that a hold of a trial ends in, peak to peak [percent of travel]; 0 for none."""
    return max(hold_cycle(error) for error in hold_errors(subject, plant, seed, open_bench))


def nominal(subject: Subject, plant: Plant, seeds: Sequence[int], open_bench: BenchFactory) -> Nominal:
    """How the controller does on the valve that it was made for."""
    holds = [error for seed in seeds for error in hold_errors(subject, plant, seed, open_bench)]
    means = [abs(float(last_quarter(error).mean())) for error in holds]
    settled = [settling_s(error, subject.tick_s) for error in holds]
    longest_s = max(math.inf if each is None else each for each in settled)
    return Nominal(max(means), max(hold_cycle(error) for error in holds), longest_s)


def hold_errors(subject: Subject, plant: Plant, seed: int, open_bench: BenchFactory) -> FloatArray:
    """The true stem's errors of every hold, shape (holds, ticks) [percent of travel]; the valve starts vented."""
    travel_in = subject.design.travel
    targets = np.repeat(np.array(TARGETS_PERCENT) * 0.01 * travel_in, round(HOLD_S / subject.tick_s))
    controller = make_controller(subject.name, subject.design, **subject.settings)
    trace = run_trial(open_bench(plant, seed), controller, targets, subject.tick_s)
    error = 100.0 * (trace.truth_in - targets) / travel_in
    return np.asarray(error.reshape(len(TARGETS_PERCENT), -1))


def bears(margin: Margin, axis: Axis) -> bool:
    """Whether nothing hunts up to the value that a bench should bear."""
    tolerated = axis.values[: axis.values.index(axis.wanted) + 1]
    return margin.bad is None or margin.bad not in tolerated


def recommended(
    as_designed: Mapping[str, Nominal], margins: Mapping[str, Mapping[str, Margin]] | None = None
) -> tuple[str | None, str]:
    """The controller to take, None where none is good enough, and why.

    The rule: no limit cycle and at most `GOAL_PERCENT` of error as designed; bears the usual differences, where margins
    were measured; of those, the one that settles first.
    """
    good = [name for name, n in as_designed.items() if n.cycle == 0.0 and n.error <= GOAL_PERCENT]
    rule = f"an error of at most {GOAL_PERCENT:g} % without a limit cycle"
    if margins is not None:
        good = [name for name in good if all(bears(margins[name][key], axis) for key, axis in AXES.items())]
        rule += ", also with 0.2 s more delay, 20 % in compliance or 20 % in deadband"
    if not good:
        return None, f"no controller has {rule}"
    best = min(good, key=lambda name: as_designed[name].settling_s)
    return best, f"of the {len(good)} that have {rule}, {best} settles first ({as_designed[best].settling_s:.1f} s)"
