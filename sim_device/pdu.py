"""Requests into replies: the functions of the Modbus application protocol, over any table of registers.

Source of every layout and exception: Modbus Application Protocol V1.1b3, section 6.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Protocol

from sim_device.diagnostics import Diagnostics
from sim_device.identity import Identity

ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE, DEVICE_FAILURE, DEVICE_BUSY = 1, 2, 3, 4, 6
COIL, HOLDING, INPUT = 1, 3, 4  # the function that reads a table also names it
_MOST_READ, _MOST_WRITTEN, _MOST_WRITTEN_23 = 125, 123, 121
_MOST_COILS_READ, _MOST_COILS_WRITTEN = 2000, 1968
_ON, _OFF = 0xFF00, 0x0000


class Refused(Exception):
    """A request that is answered with a Modbus exception code."""

    def __init__(self, code: int) -> None:
        super().__init__(f"exception {code}")
        self.code = code


class Registers(Protocol):
    """Registers (16 bits) and coils (0 or 1) with 0-based addresses; `table` is COIL, HOLDING or INPUT."""

    def check_read(self, table: int, address: int, count: int) -> None:
        """Raises: `Refused` with code 2 when a register is missing; measures nothing."""

    def read(self, table: int, address: int, count: int) -> Sequence[int]:
        """The values now. Raises: `Refused` with code 2 (missing) or 4 (the device cannot read its sensors)."""

    def check_write(self, table: int, address: int, values: Sequence[int]) -> None:
        """Raises: `Refused` with code 2 (missing or read-only) or 3 (impossible value); changes nothing."""

    def write(self, table: int, address: int, values: Sequence[int]) -> None:
        """Takes values that `check_write` accepted."""


class Server:
    """Answers the requests of one unit. What is missing in `functions` is answered with exception 1."""

    def __init__(
        self, registers: Registers, diagnostics: Diagnostics, identity: Identity, *, max_read: int = _MOST_READ
    ) -> None:
        self.registers = registers
        self._diagnostics = diagnostics
        self._identity = identity
        self._max_read = max_read
        self.functions = {
            1: self._read_coils,
            3: self._read,
            4: self._read,
            5: self._write_coil,
            6: self._write_one,
            8: self._diagnose,
            15: self._write_coils,
            16: self._write_many,
            22: self._mask,
            23: self._write_and_read,
            43: self._identify,
        }

    def answer(self, pdu: bytes) -> bytes:
        """The reply to a request (function code and data, without unit and CRC); never raises for a bad request."""
        handler = self.functions.get(pdu[0])
        try:
            if handler is None:
                raise Refused(ILLEGAL_FUNCTION)
            return handler(pdu)
        except Refused as refusal:
            self._diagnostics.refused(refusal.code)
            return bytes((pdu[0] | 0x80, refusal.code))
        except struct.error:
            self._diagnostics.refused(ILLEGAL_VALUE)
            return bytes((pdu[0] | 0x80, ILLEGAL_VALUE))

    def _values(self, table: int, address: int, count: int) -> bytes:
        words = self.registers.read(table, address, count)
        return struct.pack(f">B{count}H", 2 * count, *words)

    def _read(self, pdu: bytes) -> bytes:
        address, count = struct.unpack(">HH", pdu[1:])
        _require(1 <= count <= self._max_read, ILLEGAL_VALUE)
        return pdu[:1] + self._values(pdu[0], address, count)

    def _read_coils(self, pdu: bytes) -> bytes:
        address, count = struct.unpack(">HH", pdu[1:])
        _require(1 <= count <= _MOST_COILS_READ, ILLEGAL_VALUE)
        states = self.registers.read(COIL, address, count)
        size = (count + 7) // 8
        packed = sum((state & 1) << index for index, state in enumerate(states))
        return bytes((pdu[0], size)) + packed.to_bytes(size, "little")

    def _write_coil(self, pdu: bytes) -> bytes:
        address, state = struct.unpack(">HH", pdu[1:])
        _require(state in (_ON, _OFF), ILLEGAL_VALUE)
        self._store(COIL, address, (int(state == _ON),))
        return pdu

    def _write_coils(self, pdu: bytes) -> bytes:
        address, count, size = struct.unpack(">HHB", pdu[1:6])
        _require(1 <= count <= _MOST_COILS_WRITTEN and size == (count + 7) // 8 == len(pdu) - 6, ILLEGAL_VALUE)
        packed = int.from_bytes(pdu[6:], "little")
        self._store(COIL, address, tuple((packed >> index) & 1 for index in range(count)))
        return pdu[:5]

    def _store(self, table: int, address: int, values: Sequence[int]) -> None:
        self.registers.check_write(table, address, values)
        self.registers.write(table, address, values)

    def _write_one(self, pdu: bytes) -> bytes:
        address, value = struct.unpack(">HH", pdu[1:])
        self._store(HOLDING, address, (value,))
        return pdu

    def _write_many(self, pdu: bytes) -> bytes:
        address, count, size = struct.unpack(">HHB", pdu[1:6])
        _require(1 <= count <= _MOST_WRITTEN and size == 2 * count == len(pdu) - 6, ILLEGAL_VALUE)
        self._store(HOLDING, address, struct.unpack(f">{count}H", pdu[6:]))
        return pdu[:5]

    def _mask(self, pdu: bytes) -> bytes:
        address, keep, change = struct.unpack(">HHH", pdu[1:])
        (current,) = self.registers.read(HOLDING, address, 1)
        value = (current & keep) | (change & ~keep & 0xFFFF)
        self._store(HOLDING, address, (value,))
        return pdu

    def _write_and_read(self, pdu: bytes) -> bytes:
        read_at, read_count, address, count, size = struct.unpack(">HHHHB", pdu[1:10])
        _require(1 <= read_count <= self._max_read and 1 <= count <= _MOST_WRITTEN_23, ILLEGAL_VALUE)
        _require(size == 2 * count == len(pdu) - 10, ILLEGAL_VALUE)
        values = struct.unpack(f">{count}H", pdu[10:])
        # Both halves are checked before the write: a refused transaction must not have moved the valve.
        self.registers.check_write(HOLDING, address, values)
        self.registers.check_read(HOLDING, read_at, read_count)
        self.registers.write(HOLDING, address, values)
        return pdu[:1] + self._values(HOLDING, read_at, read_count)

    def _diagnose(self, pdu: bytes) -> bytes:
        (sub,) = struct.unpack(">H", pdu[1:3])
        if sub == 0:
            return pdu  # the loopback test returns whatever it was sent
        _require(len(pdu) == 5, ILLEGAL_VALUE)
        value = self._diagnostics.sub_function(sub, int.from_bytes(pdu[3:], "big"))
        _require(value is not None, ILLEGAL_FUNCTION)
        return pdu[:3] + struct.pack(">H", value)

    def _identify(self, pdu: bytes) -> bytes:
        _require(len(pdu) == 4 and pdu[1] == 14, ILLEGAL_FUNCTION)
        reply = self._identity.reply(pdu[2], pdu[3])
        _require(reply is not None, ILLEGAL_VALUE if pdu[2] not in (1, 2, 3, 4) else ILLEGAL_ADDRESS)
        return pdu[:3] + (reply or b"")


def _require(condition: bool, code: int) -> None:
    if not condition:
        raise Refused(code)
