"""Which faults strike a reply: drawn from a seed, so that the same replies meet the same bad luck."""

from __future__ import annotations

import random

from sim_device.faults import FRACTIONS, WireFaults


class Strikes:
    """Draws the faults of one line. `counts` tells how often each has struck."""

    def __init__(self, faults: WireFaults) -> None:
        self.faults = faults
        self.counts = dict.fromkeys((*FRACTIONS, "local_echo"), 0)
        self.random = random.Random(faults.seed)
        self._refusals_left = 0

    def hits(self, name: str) -> bool:
        fraction = getattr(self.faults, name)
        hit = bool(fraction > 0.0 and self.random.random() < fraction)
        self.counts[name] += hit
        return hit

    def mislabelled(self, unit: int, pdu: bytes) -> tuple[int, bytes]:
        """A reply as unit and PDU that is intact on the wire and, when a fault strikes, not the one asked for."""
        if self.hits("exception"):
            self._refusals_left = self.faults.exception_burst
        if self._refusals_left > 0:
            self._refusals_left -= 1
            pdu = bytes((pdu[0] | 0x80, self.faults.exception_code))
        if self.hits("wrong_unit"):
            unit = unit % 247 + 1
        if self.hits("wrong_function"):
            pdu = bytes((pdu[0] ^ 0x07,)) + pdu[1:]
        return unit, pdu

    def delay_s(self) -> float:
        """How late the reply is [s]."""
        faults = self.faults
        if not self.hits("late"):
            return 0.0
        return faults.timeout_s * self.random.uniform(faults.late_from, faults.late_to)

    def cut(self, frame: bytes) -> bytes:
        """What is left of the frame: the beginning, or nothing."""
        if self.hits("truncate"):
            frame = frame[: self.random.randrange(1, len(frame))]
        return b"" if self.hits("drop") else frame
