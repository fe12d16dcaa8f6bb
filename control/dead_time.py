"""Which dead time explains the pressure best: one hypothesis per tenth of a tick, judged by prediction errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from control.exact import decay

LONGEST_TICKS = 8
PARTS = 10  # hypotheses per tick
MEMORY = 0.97
MEANINGFUL_PSI = 0.03  # commands that differ by less cannot tell when they arrive


@dataclass(frozen=True, slots=True)
class DeadTime:
    """The last commands, the newest first [psi]; the error of each hypothesis [psi^2]; the chosen one, in tenths of a
    tick. During a tick in which one command gives way to the next, that mean of both stands for them which brings the
    converter as far; `pace` is a tick over the converter's time constant."""

    sent: tuple[float, ...]
    misses: tuple[float, ...] = (0.0,) * (LONGEST_TICKS * PARTS + 1)
    parts: int = 0
    pace: float = 0.0

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
        now = [pressure_psi - predict(command_psi) for command_psi in self._each()]
        misses = tuple(MEMORY * old + new * new for old, new in zip(self.misses, now, strict=True))
        best = min(range(len(misses)), key=misses.__getitem__)
        here = misses[self.parts]
        convincing = misses[best] < 0.6 * here and here > 4.0 * MEANINGFUL_PSI * MEANINGFUL_PSI
        return DeadTime(self.sent, misses, best if convincing else self.parts, self.pace)

    def and_sent(self, command_psi: float) -> DeadTime:
        """The queue with the command that is in force from now on."""
        return DeadTime((command_psi, *self.sent[:-1]), self.misses, self.parts, self.pace)

    def _during(self, parts: int) -> float:
        whole, part = divmod(parts, PARTS)
        return self.sent[whole] + _shares(self.pace)[part] * (self.sent[whole + 1] - self.sent[whole])

    def _each(self) -> list[float]:
        """What `arriving` would be with each hypothesis [psi]."""
        shares = _shares(self.pace)
        pairs = zip(self.sent[:LONGEST_TICKS], self.sent[1:], strict=False)
        return [new + share * (old - new) for new, old in pairs for share in shares] + [self.sent[LONGEST_TICKS]]


@cache
def _shares(pace: float) -> tuple[float, ...]:
    """The older command's share in the mean of both, for each tenth of a tick by which it stays longer."""
    if pace <= 0.0:
        return tuple(part / PARTS for part in range(PARTS))
    keep = decay(pace)
    return tuple((decay(pace * (PARTS - part) / PARTS) - keep) / (1.0 - keep) for part in range(PARTS))


def no_dead_time(command_psi: float) -> DeadTime:
    """Nothing known yet, one command in force for a while."""
    return DeadTime((command_psi,) * (LONGEST_TICKS + 2))
