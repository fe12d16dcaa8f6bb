"""The valve with its electronics in bench time: what holds the command, when the sensors are sampled, who vents."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hal.clock import Clock
from sim_device.valve import Outputs, ValvePhysics

HEALTHY, TIMED_OUT, EMERGENCY = 0, 1, 2  # what the watchdog's status register shows


@dataclass
class Watchdog:
    """Vents when nobody has spoken to the transducer for `timeout_s` [s], or at once in an emergency.

    After it has tripped, the safe value stays in force and commands are ignored until the status is cleared.
    Source: ICP DAS M-7000 series, host watchdog of the analog output modules.
    """

    timeout_s: float = 0.0
    enabled: bool = True
    status: int = HEALTHY
    trips: int = 0
    heard_s: float = 0.0

    @property
    def expires_s(self) -> float:
        """The bench time at which it will trip; infinite when it is off or has tripped."""
        armed = self.enabled and self.timeout_s > 0.0 and self.status == HEALTHY
        return self.heard_s + self.timeout_s if armed else math.inf

    def trip(self, why: int) -> None:
        self.status = why
        self.trips += 1


class Rig:
    """Carries the physics through time in the right order: trips and refreshes happen when they are due, not when
    somebody asks. `refresh_s` is the DAQ's conversion period [s]; 0 samples once per request.
    """

    def __init__(self, physics: ValvePhysics, clock: Clock, *, safe_command: float, refresh_s: float = 0.0) -> None:
        self._physics = physics
        self._clock = clock
        self._refresh_s = refresh_s
        self._refreshed = 0  # refresh periods that have passed since the origin
        self._sample_due = True
        self.command = safe_command  # what the transducer holds at its output now
        self.safe_command = safe_command
        self.sequence = 0
        self._origin_s = self._lived_s = clock.now_s()
        self.watchdog = Watchdog(heard_s=self._origin_s)
        self.outputs: Outputs = physics.advance(self._origin_s, safe_command)

    def heard(self, *, feeds_watchdog: bool) -> None:
        """A request has come in: time passes up to now, and the next read belongs to a new transaction."""
        now_s = self.advance()
        if feeds_watchdog:
            self.watchdog.heard_s = now_s
        self._sample_due = True

    def advance(self) -> float:
        """Lets the valve live up to now and returns the bench time [s]."""
        now_s = self._clock.now_s()
        if self._refresh_s > 0.0:
            passed = math.floor((now_s - self._origin_s) / self._refresh_s + 1e-9)
            if passed > self._refreshed:
                self.outputs = self._live(self._origin_s + passed * self._refresh_s)
                self.sequence += passed - self._refreshed
                self._refreshed = passed
        if now_s > self._lived_s:
            self._live(now_s)
        return now_s

    def sample(self) -> Outputs:
        """What the DAQ holds for the current request: one conversion, however many registers are read from it."""
        if self._refresh_s <= 0.0 and self._sample_due:
            self.outputs = self._live(self._clock.now_s())
            self.sequence += 1
        self._sample_due = False
        return self.outputs

    def request_command(self, command: float) -> None:
        """The transducer follows, unless its watchdog has tripped."""
        self.advance()
        if self.watchdog.status == HEALTHY:
            self.command = command

    def emergency(self) -> None:
        """Puts out the safe value now; commands are ignored until the watchdog's status is cleared."""
        self.advance()
        self.watchdog.trip(EMERGENCY)
        self.command = self.safe_command

    def clear(self) -> None:
        """Acknowledges a trip: commands count again, the output stays where it is until one comes."""
        self.watchdog.heard_s = self.advance()
        self.watchdog.status = HEALTHY

    def _live(self, to_s: float) -> Outputs:
        expires_s = self.watchdog.expires_s
        if to_s > expires_s:
            self._physics.advance(expires_s, self.command)
            self.watchdog.trip(TIMED_OUT)
            self.command = self.safe_command
        self._lived_s = to_s
        return self._physics.advance(to_s, self.command)
