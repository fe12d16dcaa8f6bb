"""Staying awake for something that is due, as long as it pays.

Who sleeps is woken up late (`hal.promptly`), who stays awake takes the processor from somebody else: on a machine whose
processors are all busy that may be the very one who is to answer. Nobody sees him: on a pseudo-terminal, and behind a
UART's interrupt, a worker of the kernel carries the bytes to the reader, and it waits for a processor like everybody
else. So each look in vain offers the processor to whoever waits for it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TypeVar

_LOOKS = 200  # about 0.2 ms
_LONGEST_REST = 256

_give_way: Callable[[], object] = getattr(os, "sched_yield", lambda: None)

Found = TypeVar("Found")


class Vigil:
    """Learns from what came of it: after each vigil in vain the next ones are left out, twice as many every time.

    `looks`: how often to look at the most; a look takes about a microsecond.
    """

    def __init__(self, looks: int = _LOOKS) -> None:
        self._looks = looks
        self._rest = 0
        self._next_rest = 1

    def keep(self, look: Callable[[], Found]) -> Found | None:
        """What `look` finds, looking again and again; None when that took too long, or does not pay at present."""
        if self._rest:
            self._rest -= 1
            return None
        for _ in range(self._looks):
            if found := look():
                self._next_rest = 1
                return found
            _give_way()
        self._rest = self._next_rest
        self._next_rest = min(2 * self._next_rest, _LONGEST_REST)
        return None
