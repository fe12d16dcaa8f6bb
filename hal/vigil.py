"""Staying awake for something that is due, as long as it pays.

Who sleeps is woken up late (`hal.promptly`), who stays awake takes the processor from somebody else: on a machine whose
processors are all busy that may be the very one who is to answer.
"""

from __future__ import annotations

from collections.abc import Callable

_LOOKS = 200  # about 0.2 ms
_LONGEST_REST = 256


class Vigil:
    """Learns from what came of it: after each vigil in vain the next ones are left out, twice as many every time."""

    def __init__(self) -> None:
        self._rest = 0
        self._next_rest = 1

    def keep(self, look: Callable[[], bytes]) -> bytes:
        """What `look` finds, looking again and again; b"" when that took too long, or does not pay at present."""
        if self._rest:
            self._rest -= 1
            return b""
        for _ in range(_LOOKS):
            if found := look():
                self._next_rest = 1
                return found
        self._rest = self._next_rest
        self._next_rest = min(2 * self._next_rest, _LONGEST_REST)
        return b""
