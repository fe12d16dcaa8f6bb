"""Faults of a Modbus TCP connection: TCP itself loses and flips nothing, so what is left is what gateways do."""

from __future__ import annotations

import struct

from sim_device.faults import Emission, WireFaults
from sim_device.strikes import Strikes

_OLDEST = 8  # how many transactions a wrong number may lie behind


class FaultyStream:
    """Applies `WireFaults` to Modbus TCP replies. A cut reply is followed by the next one without a gap.

    Source: Modbus Messaging on TCP/IP V1.0b, section 3.1.3 (MBAP header).
    """

    def __init__(self, faults: WireFaults) -> None:
        """Raises: `BadInput` for faults that only a serial line can have."""
        serial = ("noise_before", "noise_after", "bit_flip", "local_echo")
        faults.refuse(serial, "it is a fault of serial lines; for it use a pseudo-terminal or rtu+tcp://")
        self.faults = faults
        self._strikes = Strikes(faults)
        self.injected = self._strikes.counts

    def emit(self, number: int, unit: int, pdu: bytes) -> Emission:
        """The reply `pdu` of `unit` to the transaction `number`."""
        strikes = self._strikes
        unit, pdu = strikes.mislabelled(unit, pdu)
        if strikes.hits("wrong_transaction"):
            number = (number - strikes.random.randint(1, _OLDEST)) & 0xFFFF
        frame = mbap(number, unit, pdu)
        delay_s = strikes.delay_s()
        return Emission(delay_s, strikes.cut(frame))


def mbap(number: int, unit: int, pdu: bytes) -> bytes:
    """The Modbus TCP frame of a PDU."""
    return struct.pack(">HHHB", number, 0, len(pdu) + 1, unit) + pdu
