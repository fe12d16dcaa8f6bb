"""libmodbus through ctypes: the yardstick of the measurements, and a peer of the interop tests."""

from __future__ import annotations

import ctypes
import ctypes.util
import threading
from collections.abc import Sequence
from types import TracebackType
from typing import Any, Self

INSTALL = "libmodbus is not installed; on Debian and Ubuntu: apt-get install libmodbus5"


def library() -> Any:
    """The loaded library, None where it is not installed."""
    name = ctypes.util.find_library("modbus")
    if name is None:
        return None
    found = ctypes.CDLL(name, use_errno=True)
    found.modbus_new_rtu.restype = ctypes.c_void_p
    found.modbus_new_rtu.argtypes = [ctypes.c_char_p, ctypes.c_int, ctypes.c_char, ctypes.c_int, ctypes.c_int]
    found.modbus_mapping_new.restype = ctypes.c_void_p
    found.modbus_strerror.restype = ctypes.c_char_p
    return found


class LibModbus:
    """One RTU master or slave of libmodbus on a port. Raises: `OSError` with libmodbus' own words."""

    def __init__(self, port: str, unit: int, *, baud: int = 115200, timeout_s: float = 0.5) -> None:
        self._lib = library()
        if self._lib is None:
            raise OSError(INSTALL)
        self._context = ctypes.c_void_p(self._lib.modbus_new_rtu(port.encode(), baud, b"N", 8, 1))
        self._lib.modbus_set_slave(self._context, unit)
        whole = int(timeout_s)
        self._lib.modbus_set_response_timeout(self._context, whole, int(1e6 * (timeout_s - whole)))
        self._buffer = (ctypes.c_uint16 * 125)()
        self._check(self._lib.modbus_connect(self._context))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._lib.modbus_close(self._context)
        self._lib.modbus_free(self._context)

    def recover_protocol(self) -> None:
        """Lets libmodbus flush after an error (MODBUS_ERROR_RECOVERY_PROTOCOL)."""
        self._lib.modbus_set_error_recovery(self._context, 4)

    def read(self, address: int, count: int) -> list[int]:
        self._check(self._lib.modbus_read_registers(self._context, address, count, self._buffer))
        return list(self._buffer[:count])

    def write(self, address: int, values: Sequence[int]) -> None:
        words = (ctypes.c_uint16 * len(values))(*values)
        self._check(self._lib.modbus_write_registers(self._context, address, len(values), words))

    def write_and_read(self, write_at: int, values: Sequence[int], read_at: int, count: int) -> list[int]:
        words = (ctypes.c_uint16 * len(values))(*values)
        self._check(
            self._lib.modbus_write_and_read_registers(
                self._context, write_at, len(values), words, read_at, count, self._buffer
            )
        )
        return list(self._buffer[:count])

    def serve(self, stop: threading.Event) -> None:
        """Answers requests from 16 holding registers until `stop` is set; looks for it after every request."""
        mapping = ctypes.c_void_p(self._lib.modbus_mapping_new(0, 0, 16, 16))
        self._lib.modbus_set_indication_timeout(self._context, 0, 50_000)
        query = (ctypes.c_uint8 * 260)()
        while not stop.is_set():
            length = self._lib.modbus_receive(self._context, query)
            if length > 0:
                self._lib.modbus_reply(self._context, query, length, mapping)
        self._lib.modbus_mapping_free(mapping)

    def _check(self, result: int) -> None:
        if result < 0:
            number = ctypes.get_errno()
            raise OSError(number, self._lib.modbus_strerror(number).decode())
