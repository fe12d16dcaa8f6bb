"""The seam: what every bench, real or virtual, one device or two, is to the floors above."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Protocol, Self

from hal.sample import Sample


@dataclass(frozen=True, slots=True)
class BenchInfo:
    """What a record needs to know of the bench that made it. All plain values, so that it goes into JSON as it is."""

    name: str
    port: str
    command_unit: str
    command_min: float
    command_max: float
    safe_command: float
    travel_in: float
    min_period_s: float  # the shortest tick that the wire can carry with 10 % to spare
    has_pressure: bool
    identity: Mapping[str, str] = field(default_factory=dict)
    profile: Mapping[str, object] = field(default_factory=dict)


class Bench(Protocol):
    """A context manager around a valve. However it is left, the valve goes to its safe state.

    Raises: `PortFault` on entering; `WireFault`, `DeviceRefused`, `SafetyTrip` from `exchange`.
    """

    @property
    def info(self) -> BenchInfo: ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def exchange(self, command_psi: float) -> Sample:
        """Writes one command and reads pressure and position, in one transaction where the device can."""

    def make_safe(self, reason: str) -> bool:
        """Sends the safe command now; True when the device confirmed it. Never raises."""
