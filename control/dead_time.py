"""Which dead time explains the pressure best: one hypothesis per tenth of a tick, judged by prediction errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

LONGEST_TICKS = 8
PARTS = 10  # hypotheses per tick
MEMORY = 0.97
MEANINGFUL_PSI = 0.03  # commands that differ by less cannot tell when they arrive


@dataclass(frozen=True, slots=True)
class DeadTime:
    """The last commands, the newest first [psi]; the error of each hypothesis [psi^2]; the chosen one, in tenths of a
    tick. During a tick in which one command gives way to the next, that mean of both stands for them which brings the
    converter as far; `keep` is what its lag leaves of a difference in a tick."""

    sent: tuple[float, ...]
    misses: tuple[float, ...] = (0.0,) * (LONGEST_TICKS * PARTS + 1)
    parts: int = 0
    keep: float = 1.0

    @property
    def ticks(self) -> float:
        """The dead time [ticks]."""
        return self.parts / PARTS

    @property
    def arriving(self) -> float:
        """The command that reaches the converter during the tick that begins now [psi]."""
        return self._during(self.parts)

    @property
    def next_tick(self) -> tuple[tuple[float, float], ...]:
        """What `arriving` stands for: the commands of that tick [psi], each with its share of it."""
        whole, part = divmod(self.parts, PARTS)
        late = part / PARTS
        return ((self.sent[whole + 1], late), (self.sent[whole], 1.0 - late)) if part else ((self.sent[whole], 1.0),)

    @property
    def after_that(self) -> tuple[tuple[float, float], ...]:
        """The commands on their way after that tick, until the next one acts, each with its share of a tick."""
        whole, part = divmod(self.parts, PARTS)
        whole_ticks = tuple((self.sent[newer], 1.0) for newer in range(whole - 1, -1, -1))
        return ((self.sent[whole], part / PARTS), *whole_ticks) if part else whole_ticks

    def judged(self, pressure_psi: float, predict: Callable[[float], float]) -> DeadTime:
        """The hypotheses after the tick that has just ended; `predict` gives its pressure for a command."""
        now = tuple((pressure_psi - predict(self._during(q))) ** 2 for q in range(len(self.misses)))
        misses = tuple(MEMORY * old + new for old, new in zip(self.misses, now, strict=True))
        best = min(range(len(misses)), key=misses.__getitem__)
        here = misses[self.parts]
        convincing = misses[best] < 0.6 * here and here > 4.0 * MEANINGFUL_PSI**2
        return DeadTime(self.sent, misses, best if convincing else self.parts, self.keep)

    def and_sent(self, command_psi: float) -> DeadTime:
        """The queue with the command that is in force from now on."""
        return DeadTime((command_psi, *self.sent[:-1]), self.misses, self.parts, self.keep)

    def _during(self, parts: int) -> float:
        whole, part = divmod(parts, PARTS)
        late = part / PARTS
        share = late if self.keep >= 1.0 else (self.keep ** (1.0 - late) - self.keep) / (1.0 - self.keep)
        return self.sent[whole] + share * (self.sent[whole + 1] - self.sent[whole])


def no_dead_time(command_psi: float) -> DeadTime:
    """Nothing known yet, one command in force for a while."""
    return DeadTime((command_psi,) * (LONGEST_TICKS + 2))
