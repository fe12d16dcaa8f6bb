"""A fake bench inside the safety layer, for the tests of both."""

from __future__ import annotations

from hal.clock import SteppedClock
from hal.fake import FakeBench
from hal.latch import Latch
from hal.profile import Limits
from hal.safety import SafeBench
from hal.sample import Sample

LIMITS = Limits(
    command_min=1.0,
    command_max=15.0,
    slew_per_s=None,
    position_min_in=-0.05,
    position_max_in=0.6,
    pressure_max_psi=18.0,
    max_missing=3,
    max_age_s=1.0,
)


class Rig:
    """A fake bench whose readings the test chooses, inside the safety layer."""

    def __init__(self, limits: Limits = LIMITS, latch: Latch | None = None, **fake: object) -> None:
        self.clock = SteppedClock(100.0)
        self.pressure, self.position = 5.0, 0.1
        self.fake = FakeBench(self.clock, response=lambda time_s, command: (self.pressure, self.position), **fake)
        self.safe = SafeBench(self.fake, limits, self.clock, latch=latch)

    def tick(self, command: float = 5.0, dt_s: float = 0.1) -> Sample:
        sample = self.safe.exchange(command)
        self.clock.sleep_until(self.clock.now_s() + dt_s)
        return sample
