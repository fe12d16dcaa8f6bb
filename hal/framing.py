"""Bytes on an RTU line into answers: the checksum, the frame, and the hunt for one frame in whatever arrived."""

from __future__ import annotations

from hal.pdu import EXCEPTIONS, Request, identification_size


def _crc_table() -> tuple[int, ...]:
    table = []
    for value in range(256):
        for _ in range(8):
            value = (value >> 1) ^ (0xA001 if value & 1 else 0)  # noqa: PLW2901
        table.append(value)
    return tuple(table)


_TABLE = _crc_table()


def crc16(data: bytes | bytearray | memoryview) -> int:
    """CRC-16/MODBUS: 0x4B37 for b"123456789", 0 for a whole intact frame.

    Source: Modbus over serial line V1.02, section 6.2.2.
    """
    crc, table = 0xFFFF, _TABLE
    for byte in data:
        crc = (crc >> 8) ^ table[(crc ^ byte) & 0xFF]
    return crc


def seal(unit: int, pdu: bytes) -> bytes:
    """The RTU frame of a PDU: unit, PDU, CRC with its low byte first."""
    body = bytes((unit,)) + pdu
    return body + crc16(body).to_bytes(2, "little")


def find_reply(data: bytes, request: Request) -> tuple[int, int] | None:
    """Where the answer to `request` lies in `data`, as (start, end) of its frame, CRC included; None: not (yet) there.

    Only an exact match counts: unit, function, byte count or echoed fields, length and CRC. What lies around it is
    not judged here.
    """
    head = bytes((request.unit,)) + request.head
    size = request.size + 3
    if request.size and len(data) == size and data.startswith(head) and crc16(data) == 0:
        return 0, size
    return _hunt(data, request, head)


def _hunt(data: bytes, request: Request, head: bytes) -> tuple[int, int] | None:
    refusal = bytes((request.unit, request.pdu[0] | 0x80))
    start = data.find(head[:1])
    while start >= 0:
        if data.startswith(head, start):
            end = start + (request.size or identification_size(data[start + 1 :])) + 3
            if start + 3 < end <= len(data) and crc16(data[start:end]) == 0:
                return start, end
        elif data.startswith(refusal, start):
            frame = data[start : start + 5]
            if len(frame) == 5 and frame[2] in EXCEPTIONS and crc16(frame) == 0:
                return start, start + 5
        start = data.find(head[:1], start + 1)
    return None


def describe(data: bytes, request: Request) -> str:
    """One clause on why `data` is no answer, for the operator."""
    if not data:
        return "no answer"
    if len(data) >= 4 and crc16(data) == 0:
        if data[0] != request.unit:
            return f"an answer from unit {data[0]} instead of unit {request.unit}"
        return f"an intact answer to something else ({data[:8].hex(' ')}...)"
    if data.startswith(bytes((request.unit,)) + request.head[:1]):
        if request.size and len(data) < request.size + 3:
            return f"only {len(data)} of {request.size + 3} bytes"
        return f"an answer with a wrong checksum ({len(data)} bytes)"
    return f"{len(data)} bytes of garbage ({data[:8].hex(' ')}{'...' if len(data) > 8 else ''})"
