"""A bench without a wire, as strict as the real one; for tests and examples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import TracebackType
from typing import Self

from hal.bench import BenchInfo
from hal.clock import Clock
from hal.errors import BadInput, PortFault
from hal.sample import Quality, Reading, Sample

Response = Callable[[float, float], tuple[float, float]]


@dataclass
class FirstOrder:
    """A valve without backlash: pressure follows the command with `tau_s`, position is `travel_in` over 0-20 psi."""

    tau_s: float = 0.3
    travel_in: float = 0.5625
    pressure_psi: float = 0.0
    last_s: float | None = None

    def __call__(self, time_s: float, command: float) -> tuple[float, float]:
        dt_s = 0.0 if self.last_s is None else time_s - self.last_s
        self.last_s = time_s
        self.pressure_psi += (command - self.pressure_psi) * -math.expm1(-dt_s / self.tau_s)
        return self.pressure_psi, self.travel_in * self.pressure_psi / 20.0


@dataclass
class FakeBench:
    """Answers every command with `response(time_s, held command)`, and does what `script` says at given ticks.

    `script` maps the number of an exchange (from 0) to an exception to raise, or to a `Quality` to put on the
    readings (NaN for MISSING and SENTINEL). `confirms_safe` False is a device that does not listen any more.
    """

    clock: Clock
    response: Response = field(default_factory=FirstOrder)
    script: Mapping[int, BaseException | Quality] = field(default_factory=dict)
    confirms_safe: bool = True
    has_pressure: bool = True
    latency_s: float = 0.0
    commands: list[float] = field(default_factory=list)  # as they arrived
    reasons: list[str] = field(default_factory=list)  # of every `make_safe`
    open: bool = False
    entered: int = 0
    held: float = 0.0

    @property
    def info(self) -> BenchInfo:
        return BenchInfo("fake", "fake", "psi", 0.0, 20.0, 0.0, 0.5625, 0.0, self.has_pressure)

    def __enter__(self) -> Self:
        if self.open:
            raise PortFault("the fake bench is busy: it is open already")
        self.open = True
        self.entered += 1
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.make_safe("the bench is left")
        self.open = False

    def exchange(self, command_psi: float) -> Sample:
        if not self.open:
            raise PortFault("the fake bench is not open")
        if not math.isfinite(command_psi):
            raise BadInput(f"command {command_psi} is not a number that a valve can be given")
        tick = len(self.commands)
        self.commands.append(command_psi)
        event = self.script.get(tick, Quality.GOOD)
        if isinstance(event, BaseException):
            raise event
        now_s = self.clock.now_s()
        pressure_psi, position_in = self.response(now_s, self.held)
        self.held = command_psi
        good = Sample(
            time_s=now_s + 0.5 * self.latency_s,
            commanded_psi=command_psi,
            position=self._reading(position_in, now_s, event),
            readback_psi=command_psi,
            sequence=tick & 0xFFFF,
        )
        return replace(good, pressure=self._reading(pressure_psi, now_s, event)) if self.has_pressure else good

    def make_safe(self, reason: str) -> bool:
        self.reasons.append(reason)
        if self.confirms_safe:
            self.held = self.info.safe_command
        return self.confirms_safe

    def _reading(self, value: float, now_s: float, quality: Quality) -> Reading:
        lost = quality & (Quality.MISSING | Quality.SENTINEL)
        return Reading(math.nan if lost else value, now_s + 0.5 * self.latency_s, self.latency_s, quality)
