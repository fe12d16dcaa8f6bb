"""Faults of an RTU line: what happens to a frame with a checksum and no number."""

from __future__ import annotations

from sim_device.crc import sealed
from sim_device.faults import Emission, WireFaults
from sim_device.strikes import Strikes


class FaultyLine:
    """Applies `WireFaults` to RTU frames; the same seed and the same replies give the same faults."""

    def __init__(self, faults: WireFaults) -> None:
        """Raises: `BadInput` for faults that a line of RTU frames cannot have."""
        faults.refuse(("wrong_transaction",), "RTU frames carry no transaction number: it needs Modbus TCP")
        self.faults = faults
        self._strikes = Strikes(faults)
        self.injected = self._strikes.counts

    def emit(self, request: bytes, reply: bytes) -> Emission:
        """`request` and `reply` are whole frames with CRC."""
        strikes = self._strikes
        unit, pdu = strikes.mislabelled(reply[0], reply[1:-2])
        body = sealed(bytes((unit,)) + pdu)
        delay_s = strikes.delay_s()
        if strikes.hits("bit_flip"):
            at = strikes.random.randrange(8 * len(body))
            body = body[: at // 8] + bytes((body[at // 8] ^ (1 << at % 8),)) + body[at // 8 + 1 :]
        body = strikes.cut(body)
        if strikes.hits("noise_before"):
            body = self._noise() + body
        if strikes.hits("noise_after"):
            body += self._noise()
        if self.faults.local_echo:
            self.injected["local_echo"] += 1
            body = request + body
        return Emission(delay_s, body)

    def _noise(self) -> bytes:
        return self._strikes.random.randbytes(self._strikes.random.randint(1, 6))
