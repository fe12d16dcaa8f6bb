"""Where a recording stands among those that are diagnosed together."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Place:
    """Where a recording stands among those that are diagnosed together: its number, of how many.

    Where they share a clock: since when the first of them had begun, and how long they last in all, with what lies
    between them; 0 where each has a clock of its own. `broken`: so much lies between them that a drift may have begun
    anew. A part of a recording begins `within_s` after it, and the whole lasts `whole_s` (0: it is the whole). Where
    each has a clock of its own, those given before it last `before_s`, and all of them `all_s`.
    """

    number: int = 0
    of: int = 1
    since_s: float = 0.0
    span_s: float = 0.0
    within_s: float = 0.0
    whole_s: float = 0.0
    before_s: float = 0.0
    all_s: float = 0.0
    broken: bool = False

    def anew(self) -> Place:
        """The same, as if its recording had been the first."""
        return replace(self, since_s=self.within_s, before_s=0.0)


ALONE = Place()
