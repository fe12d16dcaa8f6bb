"""Which dead time explains the pressure best: one hypothesis per whole tick, judged by one-tick prediction errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

LONGEST_TICKS = 8
MEMORY = 0.97
MEANINGFUL_PSI = 0.05  # commands that differ by less cannot tell when they arrive


@dataclass(frozen=True, slots=True)
class DeadTime:
    """The last commands, the newest first [psi]; the error of each hypothesis [psi^2]; the chosen one [ticks]."""

    sent: tuple[float, ...]
    misses: tuple[float, ...] = (0.0,) * (LONGEST_TICKS + 1)
    ticks: int = 0

    @property
    def arriving(self) -> float:
        """The command that reaches the converter during the tick that begins now [psi]."""
        return self.sent[self.ticks]

    @property
    def queued(self) -> tuple[float, ...]:
        """The commands on their way after that one, in the order in which they arrive [psi]."""
        return self.sent[: self.ticks][::-1]

    def judged(self, pressure_psi: float, predict: Callable[[float], float]) -> DeadTime:
        """The hypotheses after the tick that has just ended; `predict` gives its pressure for a command."""
        now = tuple((pressure_psi - predict(u)) ** 2 for u in self.sent)
        misses = tuple(MEMORY * old + new for old, new in zip(self.misses, now, strict=True))
        best = min(range(len(misses)), key=misses.__getitem__)
        convincing = misses[best] < 0.6 * misses[self.ticks] and misses[self.ticks] > 4.0 * MEANINGFUL_PSI**2
        return DeadTime(self.sent, misses, best if convincing else self.ticks)

    def and_sent(self, command_psi: float) -> DeadTime:
        """The queue with the command that is in force from now on."""
        return DeadTime((command_psi, *self.sent[:-1]), self.misses, self.ticks)


def no_dead_time(command_psi: float) -> DeadTime:
    """Nothing known yet, one command in force for a while."""
    return DeadTime((command_psi,) * (LONGEST_TICKS + 1))
