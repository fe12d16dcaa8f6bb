"""The seam between the physics of the virtual valve and everything that speaks Modbus about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Outputs:
    """What the transmitters of the valve see at one moment: sensor imperfections included, before any ADC counts."""

    pressure_psi: float
    position_in: float
    supply_psi: float
    temperature_c: float


class ValvePhysics(Protocol):
    """A valve that can be asked what it does; it reads no clock and knows no registers."""

    def advance(self, to_time_s: float, command: float) -> Outputs:
        """Holds `command` from the last time up to `to_time_s` [s, monotonic] and returns what the sensors see then.

        `command` is a pressure [psi], for the positioner variant a position [percent]. The first call sets the
        origin. A time that is not later than the last leaves the valve where it is. Deterministic for its seed.
        """
