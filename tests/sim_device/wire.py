"""A master that is nothing but bytes."""

from __future__ import annotations

import os
import select
import tty
from types import TracebackType
from typing import Self

from sim_device.crc import sealed


class Wire:
    """Writes and reads raw bytes on a port; gives up after `patience_s` [s]."""

    def __init__(self, port: str, patience_s: float = 2.0) -> None:
        self.fd = os.open(port, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.fd)
        self._patience_s = patience_s

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self.fd)

    def send(self, data: bytes) -> None:
        os.write(self.fd, data)

    def receive(self, size: int) -> bytes:
        """`size` bytes, or fewer when they do not come."""
        data = b""
        while len(data) < size and select.select([self.fd], [], [], self._patience_s)[0]:
            data += os.read(self.fd, size - len(data))
        return data

    def waiting(self) -> bool:
        """Whether bytes have arrived that nobody has read."""
        return bool(select.select([self.fd], [], [], 0)[0])

    def ask(self, request_hex: str, size: int) -> str:
        """Sends a request without its CRC and returns the reply without its CRC; both in hex."""
        self.send(sealed(bytes.fromhex(request_hex)))
        reply = self.receive(size + 2)
        assert reply == sealed(reply[:-2]), f"no intact reply to {request_hex}: {reply.hex(' ')}"
        return reply[:-2].hex(" ")
