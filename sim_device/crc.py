"""The checksum of a Modbus RTU frame, on the slave's side.

Deliberately not shared with the master's: a mistake made twice would cancel out on a virtual line.
"""

from __future__ import annotations

_POLYNOMIAL = 0xA001  # x^16 + x^15 + x^2 + 1, least significant bit first


def _table() -> tuple[int, ...]:
    rows = []
    for byte in range(256):
        remainder = byte
        for _ in range(8):
            remainder = (remainder >> 1) ^ (_POLYNOMIAL if remainder & 1 else 0)
        rows.append(remainder)
    return tuple(rows)


_TABLE = _table()


def crc16(data: bytes | bytearray) -> int:
    """The CRC of `data`; 0 over a whole frame (checksum included) means that the frame is intact.

    Source: Modbus over serial line V1.02, section 6.2.2.
    """
    remainder = 0xFFFF
    for byte in data:
        remainder = (remainder >> 8) ^ _TABLE[(remainder ^ byte) & 0xFF]
    return remainder


def sealed(body: bytes) -> bytes:
    """`body` (unit, function, data) with its CRC appended, low byte first."""
    return body + crc16(body).to_bytes(2, "little")
