"""The counters that a slave keeps of its line, read and cleared through function 8."""

from __future__ import annotations

from dataclasses import dataclass, field

_CLEAR, _RESTART, _DIAGNOSTIC_REGISTER = 10, 1, 2


def _zeros() -> dict[int, int]:
    return dict.fromkeys(range(11, 19), 0)


@dataclass
class Diagnostics:
    """Counts by sub-function: 11 frames seen, 12 damaged, 13 exceptions, 14 for this unit, 15 unanswered, 17 busy.

    Source: Modbus Application Protocol V1.1b3, section 6.8. 16 (NAK) and 18 (overrun) stay 0: this slave has neither.
    """

    counts: dict[int, int] = field(default_factory=_zeros)

    def saw_frame(self) -> None:
        self.counts[11] += 1

    def saw_damage(self, times: int = 1) -> None:
        self.counts[12] += times

    def addressed(self, *, answered: bool) -> None:
        self.counts[14] += 1
        if not answered:
            self.counts[15] += 1

    def refused(self, code: int) -> None:
        self.counts[13] += 1
        if code == 6:
            self.counts[17] += 1

    def sub_function(self, sub: int, data: int) -> int | None:
        """The value that a sub-function returns (16 bits), None when there is no such sub-function."""
        if sub == _DIAGNOSTIC_REGISTER:
            return 0
        if sub in (_CLEAR, _RESTART):
            self.counts = _zeros()
            return data
        count = self.counts.get(sub)
        return None if count is None else count & 0xFFFF
