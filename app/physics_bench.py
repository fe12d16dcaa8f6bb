"""A bench with the virtual valve's physics behind it and no wire in between: the fast way to run many trials."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Any, Self

from control.trial import Opened
from hal.bench import BenchInfo
from hal.clock import Clock, SteppedClock
from hal.sample import Reading, Sample
from sim_device.physics.catalog import make_physics
from sim_device.valve import ValvePhysics


class PhysicsBench:
    """Implements `hal.bench.Bench` on a `ValvePhysics`. Exact readings, no latency, no counts.

    `highest` is where the range of commands ends, in their unit.
    """

    def __init__(self, physics: ValvePhysics, clock: Clock, unit: str = "psi", highest: float = 20.0) -> None:
        self.physics = physics
        self._clock = clock
        self._command = 0.0
        self._info = BenchInfo(
            name="virtual valve without a wire",
            port="none",
            command_unit=unit,
            command_min=0.0,
            command_max=highest if unit == "psi" else 100.0,
            safe_command=0.0,
            travel_in=0.5625,
            min_period_s=0.0,
            has_pressure=True,
        )

    @property
    def info(self) -> BenchInfo:
        return self._info

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.make_safe("the end")

    def exchange(self, command_psi: float) -> Sample:
        now_s = self._clock.now_s()
        seen = self.physics.advance(now_s, self._command)
        self._command = min(max(command_psi, self._info.command_min), self._info.command_max)
        return Sample(
            now_s,
            self._command,
            Reading(seen.position_in, now_s, 0.0),
            Reading(seen.pressure_psi, now_s, 0.0),
            readback_psi=self._command,
        )

    def make_safe(self, reason: str) -> bool:
        self._command = 0.0
        return True


def open_virtual(
    seed: int,
    *,
    numbers: Mapping[str, float] | None = None,
    effects: Mapping[str, float] | None = None,
    noise: float = 1.0,
    name: str = "thesis",
    highest_psi: float = 20.0,
) -> Opened:
    """A fresh virtual valve with its own stepped clock, and the way to ask where its stem really is."""
    physics = make_physics(name, seed, noise=noise, effects=dict(effects or {}), **dict(numbers or {}))
    clock = SteppedClock()
    bench = PhysicsBench(physics, clock, "percent" if name == "positioner" else "psi", highest_psi)
    return Opened(bench, clock, stem_of(physics))


def stem_of(physics: ValvePhysics) -> Callable[[], float] | None:
    """Asks a plant for its true stem position [in], where it can tell."""
    state: Any = getattr(physics, "state", None)
    if state is None or "stem" not in (state.dtype.names or ()):
        return None

    def truth_in() -> float:
        return float(state["stem"][0])

    return truth_in
