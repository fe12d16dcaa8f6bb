"""What the device's sequence register says about the age of what came with it."""

from __future__ import annotations

from dataclasses import dataclass

from hal.sample import Quality

_SIZE = 65536
_NEAR_WRAP = 8192  # a count that falls is a wrap when it falls from the top to the bottom, else a restart


@dataclass
class Freshness:
    """Remembers the last sequence number."""

    last: int | None = None

    def judge(self, sequence: int) -> Quality:
        """STALE when the number did not move, RESTARTED when it fell other than by wrapping at 65536."""
        last, self.last = self.last, sequence
        if last is None:
            return Quality.GOOD
        if sequence == last:
            return Quality.STALE
        wrapped = last >= _SIZE - _NEAR_WRAP and sequence < _NEAR_WRAP
        return Quality.RESTARTED if sequence < last and not wrapped else Quality.GOOD
