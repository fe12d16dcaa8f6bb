"""What is asked, and what the only acceptable answer looks like. No checksums here: those are framing.

Source of every layout: Modbus Application Protocol V1.1b3, section 6.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import NamedTuple

EXCEPTIONS = {
    1: "illegal function",
    2: "illegal data address",
    3: "illegal data value",
    4: "device failure",
    5: "acknowledge",
    6: "device busy",
    7: "negative acknowledge",
    8: "memory parity error",
    10: "gateway path unavailable",
    11: "gateway target failed to respond",
}


class Request(NamedTuple):
    """One request and the answer it accepts: a PDU that begins with `head` and is `size` bytes long (0: see `ends`).

    `echoes` marks functions whose answer repeats the request, which a line with local echo would fake.
    """

    unit: int
    pdu: bytes
    head: bytes
    size: int
    echoes: bool = False

    @property
    def function(self) -> int:
        return self.pdu[0]

    def accepts(self, pdu: bytes) -> bool:
        """Whether `pdu` answers this request: exactly this shape, or an exception to this function."""
        if len(pdu) == 2 and pdu[0] == self.pdu[0] | 0x80:
            return pdu[1] in EXCEPTIONS
        return pdu.startswith(self.head) and len(pdu) == (self.size or identification_size(pdu))


def read_registers(unit: int, function: int, address: int, count: int) -> Request:
    """Functions 3 (holding) and 4 (input): `count` registers from `address`, counted from 0."""
    pdu = struct.pack(">BHH", function, address, count)
    return Request(unit, pdu, bytes((function, 2 * count)), 2 + 2 * count)


def read_coils(unit: int, address: int, count: int = 1) -> Request:
    """Function 1."""
    size = (count + 7) // 8
    return Request(unit, struct.pack(">BHH", 1, address, count), bytes((1, size)), 2 + size)


def write_coil(unit: int, address: int, on: bool) -> Request:
    """Function 5."""
    pdu = struct.pack(">BHH", 5, address, 0xFF00 if on else 0)
    return Request(unit, pdu, pdu, 5, echoes=True)


def write_register(unit: int, address: int, value: int) -> Request:
    """Function 6."""
    pdu = struct.pack(">BHH", 6, address, value)
    return Request(unit, pdu, pdu, 5, echoes=True)


def write_registers(unit: int, address: int, values: Sequence[int]) -> Request:
    """Function 16."""
    count = len(values)
    pdu = struct.pack(f">BHHB{count}H", 16, address, count, 2 * count, *values)
    return Request(unit, pdu, pdu[:5], 5)


def write_and_read(unit: int, write_address: int, values: Sequence[int], address: int, count: int) -> Request:
    """Function 23; the device writes before it reads."""
    written = len(values)
    pdu = struct.pack(f">BHHHHB{written}H", 23, address, count, write_address, written, 2 * written, *values)
    return Request(unit, pdu, bytes((23, 2 * count)), 2 + 2 * count)


def echo(unit: int, nonce: int) -> Request:
    """Function 8, sub-function 0: the device returns `nonce` (16 bits)."""
    pdu = struct.pack(">BHH", 8, 0, nonce)
    return Request(unit, pdu, pdu, 5, echoes=True)


def identify(unit: int, access: int = 1, first: int = 0) -> Request:
    """Function 43, MEI type 14: `access` 1 basic, 2 regular, 3 extended objects."""
    return Request(unit, bytes((43, 14, access, first)), bytes((43, 14, access)), 0)


def words_of(pdu: bytes) -> tuple[int, ...]:
    """The registers in an answer to function 3, 4 or 23."""
    return struct.unpack(f">{pdu[1] // 2}H", pdu[2:])


def objects_of(pdu: bytes) -> tuple[dict[int, str], int | None]:
    """The identification objects in an answer to function 43/14, and the object to ask for next (None: complete)."""
    found, at = {}, 7
    for _ in range(pdu[6]):
        number, length = pdu[at], pdu[at + 1]
        found[number] = pdu[at + 2 : at + 2 + length].decode("ascii", "replace")
        at += 2 + length
    return found, pdu[5] if pdu[4] == 0xFF else None


def identification_size(pdu: bytes) -> int:
    """The length of the answer to function 43/14 that starts here; 0 while that cannot be known.

    (An exception to it does not come here.) Source: section 6.21.
    """
    if len(pdu) < 7:
        return 0
    at = 7
    for _ in range(pdu[6]):
        if len(pdu) < at + 2:
            return 0
        at += 2 + pdu[at + 1]
    return at
