"""Absolute deadlines: tick k is due at origin + k * period, however long the ticks before it took."""

from __future__ import annotations

import math

from hal.clock import Clock


class Ticker:
    """Counts deadlines. A tick that comes a whole period late or more skips the deadlines it has missed."""

    def __init__(self, clock: Clock, period_s: float) -> None:
        self.period_s = period_s
        self.origin_s = clock.now_s()
        self.index = -1  # number of the deadline that was waited for last
        self.lateness_s = 0.0  # how long after its deadline the last wait returned
        self.skipped = 0  # deadlines that the last wait left out
        self.overruns = 0
        self.worst_lateness_s = 0.0
        self._clock = clock

    @property
    def due_s(self) -> float:
        """The bench time of the next deadline [s]."""
        return self.origin_s + (self.index + 1) * self.period_s

    def wait(self) -> int:
        """Returns at the next deadline that has not been missed altogether, with its number."""
        due_s = self.due_s
        self._clock.sleep_until(due_s)
        late_s = max(0.0, self._clock.now_s() - due_s)
        self.skipped = math.floor(late_s / self.period_s + 1e-9)
        self.index += 1 + self.skipped
        self.lateness_s = late_s
        self.overruns += self.skipped > 0
        self.worst_lateness_s = max(self.worst_lateness_s, late_s)
        return self.index
