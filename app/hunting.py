"""Predicted against measured limit cycles: P and PI on the virtual valve, over gains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.physics_bench import open_virtual
from control.analysis.harmonic_balance import Balanced, balance
from control.analysis.limit_cycle import LimitCycle, predict
from control.analysis.loop import LinearLoop
from control.analysis.measured import MeasuredCycle, measure_cycle
from control.controller import make_controller
from control.design import DesignModel
from control.trial import Trace, run_trial

RESIDUAL = 0.01
PI_GAINS = ((3.0, 1.0), (3.0, 3.0), (3.0, 6.0), (3.0, 8.0), (3.0, 10.0), (10.0, 5.0))


@dataclass(frozen=True, slots=True)
class Case:
    """One loop: what the describing function says of it, what harmonic balance says, what the virtual valve does."""

    loop: LinearLoop
    predicted: LimitCycle | None
    balanced: Balanced | None
    measured: MeasuredCycle | None

    @property
    def agrees(self) -> bool:
        """Whether there is a limit cycle, in the prediction and on the valve alike."""
        return (self.predicted is None) == (self.measured is None)


def gains() -> list[LinearLoop]:
    """The loops of the standard study."""
    loops = [LinearLoop("p", kp) for kp in (3.0, 15.8, 60.0)]
    loops += [LinearLoop("p_incremental", kp) for kp in (1.0, 1.5, 2.0, 3.0, 4.0)]
    loops += [LinearLoop("pi", kp, ki) for kp, ki in PI_GAINS]
    return loops


def study(loops: Sequence[LinearLoop], design: DesignModel, duration_s: float = 1200.0) -> list[Case]:
    """Every loop predicted, balanced and measured. The valve's stops are far away and its readings without noise, so
    that the comparison is about the loop; its travel is four times the design's."""
    return [_case(loop, design, duration_s) for loop in loops]


def _case(loop: LinearLoop, design: DesignModel, duration_s: float) -> Case:
    stable = [cycle for cycle in predict(loop, design) if cycle.stable]
    predicted = stable[-1] if stable else None
    balanced = _balanced(loop, design, predicted) if predicted else None
    trace = measure(loop, design, duration_s)
    return Case(loop, predicted, balanced, measure_cycle(trace.time_s, trace.truth_in, 0.01 * design.travel))


def _balanced(loop: LinearLoop, design: DesignModel, near: LimitCycle) -> Balanced | None:
    """The harmonic balance, begun at the prediction and, where the rate limit may have moved it to, further out; of
    several solutions the largest, because the valve comes from a large step."""
    solutions = []
    for larger, slower in ((1.0, 1.0), (1.5, 1.2), (2.2, 1.5), (3.0, 2.0)):
        begin = replace(near, pressure_psi=near.pressure_psi * larger, omega=near.omega / slower)
        solutions.append(balance(loop, design, begin))
    good = [found for found in solutions if found.residual < RESIDUAL]
    return max(good, key=lambda found: found.stem_in) if good else None


def measure(loop: LinearLoop, design: DesignModel, duration_s: float) -> Trace:
    """The loop on the virtual valve: kicked by a large step, then left alone at a quarter of that travel."""
    wide = replace(design, travel=4.0 * design.travel)
    settings = {"kp": loop.kp} | ({"ki": loop.ki} if loop.law == "pi" else {})
    limits = {"min_psi": -200.0, "max_psi": 200.0}
    controller = make_controller(loop.law, wide, **settings, **limits)
    opened = open_virtual(0, numbers={"travel": wide.travel}, noise=0.0)
    targets = np.full(round(duration_s / loop.tick_s), 0.25 * wide.travel)
    targets[: round(20.0 / loop.tick_s)] = 0.4 * wide.travel
    return run_trial(opened, controller, targets, loop.tick_s)
