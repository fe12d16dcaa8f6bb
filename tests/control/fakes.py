"""A bench and sinks for tests of the loop: no wire, stepped time, faults on request."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

from hal.bench import BenchInfo
from hal.clock import SteppedClock
from hal.errors import WireFault
from hal.sample import Quality, Reading, Sample
from tests.control.toy_valve import Toy


@dataclass
class ToyBench:
    """A valve of the interface document's equations; `before(tick)` may raise, or make time pass."""

    clock: SteppedClock
    toy: Toy = field(default_factory=Toy)
    before: Callable[[int], None] = lambda _: None
    unit: str = "psi"
    safe_confirmed: bool = True
    min_period_s: float = 0.001
    has_pressure: bool = True
    tick: int = -1
    commands: list[float] = field(default_factory=list)
    made_safe: list[str] = field(default_factory=list)
    command: float = 0.0
    p: float = 0.0
    w: float = 0.0
    x: float = 0.0
    time_s: float | None = None

    @property
    def info(self) -> BenchInfo:
        return BenchInfo(
            "toy", "none", self.unit, 0.0, 20.0, 0.0, self.toy.travel, self.min_period_s, self.has_pressure
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.make_safe("left")

    def exchange(self, command_psi: float) -> Sample:
        self.tick += 1
        self.before(self.tick)
        self._live(self.clock.now_s())
        self.command = command_psi
        self.commands.append(command_psi)
        now_s = self.clock.now_s()
        pressure = Reading(self.p, now_s, 0.0) if self.has_pressure else None
        return Sample(now_s, command_psi, Reading(self.x, now_s, 0.0), pressure, sequence=self.tick)

    def make_safe(self, reason: str) -> bool:
        self.made_safe.append(reason)
        self.command = 0.0
        return self.safe_confirmed

    def _live(self, now_s: float) -> None:
        v, last_s = self.toy, now_s if self.time_s is None else self.time_s
        steps = round((now_s - last_s) / 0.02)
        for _ in range(steps):
            h = (now_s - last_s) / steps
            self.p = self.command + (self.p - self.command) * math.exp(-h / v.ep_tau)
            before = self.w
            self.w = min(max(v.k1 * (self.p - v.a1), min(v.k2 * (self.p - v.a2), self.w), 0.0), v.travel)
            moved = (0.5 * (before + self.w) - self.x) * (1.0 - math.exp(-h / v.tau))
            self.x = min(max(self.x + min(max(moved, -v.rate * h), v.rate * h), 0.0), v.travel)
        self.time_s = now_s


def lost(ticks: set[int]) -> Callable[[int], None]:
    """Raises `WireFault` in these ticks."""

    def before(tick: int) -> None:
        if tick in ticks:
            raise WireFault("no reply within 250 ms")

    return before


@dataclass
class Memory:
    """A sink and a record that keep everything."""

    rows: list[Mapping[str, float]] = field(default_factory=list)
    events: list[tuple[float | None, str, str]] = field(default_factory=list)
    notes: list[tuple[float | None, str]] = field(default_factory=list)
    states: list[tuple[float | None, str]] = field(default_factory=list)
    closed: list[tuple[str, str]] = field(default_factory=list)

    def append(self, row: Mapping[str, float]) -> None:
        self.rows.append(dict(row))

    def event(self, time_s: float | None, level: str, text: str) -> None:
        self.events.append((time_s, level, text))

    def note(self, time_s: float | None, text: str) -> None:
        self.notes.append((time_s, text))

    def state(self, time_s: float | None, text: str) -> None:
        self.states.append((time_s, text))

    def close(self, status: str, reason: str) -> None:
        self.closed.append((status, reason))

    def column(self, name: str) -> list[float]:
        return [row.get(name, math.nan) for row in self.rows]


MISSING = int(Quality.MISSING)
