"""What even an oracle has to ask its gauges: where the pilot has wandered to, and so where the plate came to rest."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

PILOT_PSI, PILOT_S = 0.003, 40.0  # deviation and correlation time of the pilot's unrest, for unit noise
PRESSURE_PSI, POSITION_IN = 0.004, 0.0006  # deviation of one reading, for unit noise
SLOW_SHARE, SLOW_S = 0.19, 0.3  # the share of a reading's noise that is slow, and how slow that is


@dataclass(frozen=True, slots=True)
class Doubt:
    """Means of the unrest [psi] and of how far the plate is from where it is thought to be [in], and their covariance:
    a Kalman filter of two numbers. `noise` is the scenario's factor; `since_s`, since the plate stopped."""

    noise: float
    wander_psi: float = 0.0
    off_in: float = 0.0
    wander_var: float = 0.0
    both: float = 0.0
    off_var: float = 0.0
    since_s: float = 0.0

    @property
    def off_sd_in(self) -> float:
        """Standard deviation of where the plate is [in]."""
        return math.sqrt(max(self.off_var, 0.0))

    def later(self, dt_s: float) -> Doubt:
        """After a tick in which nothing was read and the plate lay still."""
        keep, power = math.exp(-dt_s / PILOT_S), (self.noise * PILOT_PSI) ** 2
        variance = keep * keep * self.wander_var + (1.0 - keep * keep) * power
        return replace(
            self,
            wander_psi=keep * self.wander_psi,
            wander_var=variance,
            both=keep * self.both,
            since_s=self.since_s + dt_s,
        )

    def pushed(self, compliance: float) -> Doubt:
        """While an edge pushes the plate: it is off by the compliance [in/psi] times what the unrest is mistaken by."""
        both = compliance * self.wander_var
        return replace(self, off_in=0.0, both=both, off_var=compliance * both, since_s=0.0)

    def on_stop(self) -> Doubt:
        """Pressed against an end stop, the plate is there."""
        return replace(self, off_in=0.0, both=0.0, off_var=0.0, since_s=0.0)

    def read(self, off_psi: float, off_in: float, share: float, dt_s: float) -> Doubt:
        """After readings of pressure and stem that differ by so much from the ghost's; the stem has gone `share` of the
        way to where the plate really is."""
        return self._learned(1.0, 0.0, off_psi, PRESSURE_PSI, dt_s)._learned(0.0, share, off_in, POSITION_IN, dt_s)

    def _learned(self, of_wander: float, of_off: float, off: float, one: float, dt_s: float) -> Doubt:
        variance = (self.noise * one) ** 2 * (1.0 - SLOW_SHARE + SLOW_SHARE * 2.0 * SLOW_S / dt_s)
        toward_wander = self.wander_var * of_wander + self.both * of_off
        toward_off = self.both * of_wander + self.off_var * of_off
        power = of_wander * toward_wander + of_off * toward_off + variance
        miss = off - of_wander * self.wander_psi - of_off * self.off_in
        return replace(
            self,
            wander_psi=self.wander_psi + toward_wander / power * miss,
            off_in=self.off_in + toward_off / power * miss,
            wander_var=self.wander_var - toward_wander * toward_wander / power,
            both=self.both - toward_wander * toward_off / power,
            off_var=self.off_var - toward_off * toward_off / power,
        )


def outside(mean: float, sd: float, within: float) -> float:
    """The chance that a normal number is further than `within` from 0."""
    if sd <= 0.0:
        return float(abs(mean) > within)
    return 0.5 * sum(math.erfc((within + sign * mean) / (sd * math.sqrt(2.0))) for sign in (-1.0, 1.0))
