"""Predicted against measured limit cycles: P and PI on the virtual valve, over gains and dead times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.physics_bench import open_virtual
from control.analysis.harmonic_balance import Balanced, find_cycles
from control.analysis.limit_cycle import LimitCycle, grows, predict
from control.analysis.loop import LinearLoop
from control.analysis.measured import MeasuredCycle, measure_cycle
from control.controller import Controller, make_controller
from control.design import DesignModel
from control.late_gauge import with_late_gauge
from control.trial import Opened, Trace, follow_targets

PI_GAINS = ((3.0, 1.0), (3.0, 3.0), (3.0, 6.0), (3.0, 8.0), (3.0, 10.0), (10.0, 5.0))
DURATION_S = 1200.0
KICK_S = 20.0
AWAY = 8.0  # times the travel: so far away are the stops of the valve that is measured
LIFT_PSI = 100.0  # its curves lie so much higher: far from vacuum, and from the command's ends
CONDITIONS = (
    "Measured without a wire on the virtual valve with the design's numbers, without noise, with its stops, vacuum and "
    "the command's ends out of reach (travel x 8, curves 100 psi higher), from rest, after a step of 0.6 travels"
)
WIRED = "Over Modbus: the same valve with its real stops, 0 to 20 psi and reading noise, held at half travel"


@dataclass(frozen=True, slots=True)
class Case:
    """One loop: the describing function's stable limit cycle, those that harmonic balance finds (largest first), what
    the virtual valve does, whether large oscillations of the linear loop grow without end, and, where that was asked
    for, what the valve does over Modbus with its real stops."""

    loop: LinearLoop
    predicted: LimitCycle | None
    balanced: tuple[Balanced, ...]
    measured: MeasuredCycle | None
    grows: bool = False
    wired: MeasuredCycle | None = None


def gains(base: LinearLoop) -> list[LinearLoop]:
    """The loops of the standard study, with the lags, ticks and delays of `base`."""
    loops = [replace(base, law="p", kp=kp, ki=0.0) for kp in (3.0, 15.8, 60.0)]
    loops += [replace(base, law="p_incremental", kp=kp, ki=0.0) for kp in (1.0, 1.5, 2.0, 2.5, 3.0, 4.0)]
    loops += [replace(base, law="pi", kp=kp, ki=ki) for kp, ki in PI_GAINS]
    return loops


def study(
    loops: Sequence[LinearLoop], design: DesignModel, duration_s: float = DURATION_S, wired: bool = False
) -> Iterator[Case]:
    """Every loop predicted, balanced and measured, one after the other; the conditions are in `CONDITIONS`."""
    for loop in loops:
        cycles = tuple(find_cycles(loop, design))
        over_modbus = measure_wired(loop, design, duration_s) if wired else None
        found = measured(loop, design, duration_s)
        yield Case(loop, predicted(loop, design), cycles, found, grows(loop, design), over_modbus)


def predicted(loop: LinearLoop, design: DesignModel) -> LimitCycle | None:
    """The largest stable limit cycle of the describing function."""
    stable = [cycle for cycle in predict(loop, design) if cycle.stable]
    return stable[-1] if stable else None


def measured(loop: LinearLoop, design: DesignModel, duration_s: float = DURATION_S) -> MeasuredCycle | None:
    """What the virtual valve does, under `CONDITIONS`."""
    trace = measure(loop, design, duration_s)
    return measure_cycle(trace.time_s, trace.truth_in, 0.005 * design.travel)


def measure(loop: LinearLoop, design: DesignModel, duration_s: float) -> Trace:
    """The loop on the virtual valve: brought to rest, kicked by a step of 0.6 travels, then left alone."""
    wide = replace(design, travel=AWAY * design.travel, a1=design.a1 + LIFT_PSI, a2=design.a2 + LIFT_PSI)
    opened = open_virtual(
        0,
        numbers=plant_numbers(wide),
        effects={"dead_time": loop.dead_time_s},
        noise=0.0,
        highest_psi=3.0 * LIFT_PSI,
    )
    opened, tick_s = with_late_gauge(opened, loop.late_s), loop.tick_s
    middle_in = 0.5 * wide.travel
    rest_psi = wide.a1 + middle_in / wide.compliance
    rest_s = middle_in / wide.rate_limit + 10.0 * (wide.tau_s + wide.ep_tau_s) + loop.dead_time_s + loop.late_s
    targets = np.full(round((KICK_S + duration_s) / tick_s), middle_in)
    targets[: round(KICK_S / tick_s)] = middle_in + 0.6 * design.travel
    with opened.bench:
        for tick in range(round(rest_s / tick_s)):
            opened.bench.exchange(rest_psi)
            opened.clock.sleep_until((tick + 1) * tick_s)
        return follow_targets(opened, _controller(loop, wide, max_psi=3.0 * LIFT_PSI), targets, tick_s, rest_psi)


def measure_wired(loop: LinearLoop, design: DesignModel, duration_s: float = DURATION_S) -> MeasuredCycle | None:
    """The same over Modbus frames on a pseudo-terminal, under `WIRED`; what the LVDT reads."""
    from app.session import open_bench

    targets = np.full(round(duration_s / loop.tick_s), 0.5 * design.travel)
    with open_bench(options=dict(plant_numbers(design)), effects=[f"dead_time={loop.dead_time_s}"]) as session:
        opened = with_late_gauge(Opened(session.bench, session.clock), loop.late_s)
        trace = follow_targets(opened, _controller(loop, design), targets, loop.tick_s)
    return measure_cycle(trace.time_s, trace.position_in, 0.01 * design.travel)


def plant_numbers(design: DesignModel) -> dict[str, float]:
    """A design's numbers as the virtual valve takes them."""
    return {
        "a1": design.a1,
        "a2": design.a2,
        "compliance": design.compliance,
        "tau": design.tau_s,
        "rate_limit": design.rate_limit,
        "travel": design.travel,
        "ep_tau": design.ep_tau_s,
    }


def first_gain(hunts: Callable[[float], bool], gains: Sequence[float]) -> float:
    """The lowest gain of `gains` that hunts; infinite where none does. Goes up one by one: hunting need not be
    monotonic in the gain."""
    return next((gain for gain in gains if hunts(gain)), float("inf"))


def _controller(loop: LinearLoop, design: DesignModel, **limits: float) -> Controller[float]:
    settings = {"kp": loop.kp} | ({"ki": loop.ki} if loop.law == "pi" else {})
    return make_controller(loop.law, design, **settings, **limits)
