"""Proportional control, the incremental reading of figure 3-1: Kp times the error is added to the measured pressure."""

from __future__ import annotations

from dataclasses import dataclass

from control.controller import Law, Seen


@dataclass(frozen=True)
class ProportionalIncremental(Law[None]):
    """P_signal = P_measurement + Kp (target - position), Kp in psi/in, once per tick.

    The measured pressure is an accumulator: the converter keeps what it was told, so that this "proportional" law
    integrates with about Kp / (ep tau + tick) psi/s per inch, and together with the play it hunts.
    """

    kp: float = 3.0

    def start(self, seen: Seen, target_in: float) -> None:
        return None

    def law(self, state: None, seen: Seen, target_in: float, dt_s: float) -> tuple[None, float]:
        return None, seen.pressure_psi + self.kp * (target_in - seen.position_in)


CONTROLLER = ProportionalIncremental
