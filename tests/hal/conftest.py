"""A slave that nobody trusts: registers hold their own address, on a real pseudo-terminal, with scripted faults."""

from __future__ import annotations

import os
import select
import struct
import threading
import tty
from collections.abc import Callable, Iterator

import pytest

from hal.framing import crc16, seal

Fault = tuple[object, ...]  # ("ok",), ("late", n), ("noise", bytes), ("after", bytes), ("flip", bit), ("drop",), ...
Script = Callable[[int, bytes], Fault]


def always_ok(index: int, request: bytes) -> Fault:
    return ("ok",)


def request_size(data: bytes) -> int:
    if len(data) < 2:
        return 0
    if data[1] in (15, 16):
        return 9 + data[6] if len(data) > 6 else 0
    if data[1] == 23:
        return 13 + data[10] if len(data) > 10 else 0
    return 7 if data[1] == 43 else 8


def answer(frame: bytes) -> bytes:
    """The right answer of unit `frame[0]`, whose every register holds its address."""
    unit, function = frame[0], frame[1]
    if function in (3, 4, 23):
        address, count = struct.unpack(">HH", frame[2:6])
        words = [(address + i) & 0xFFFF for i in range(count)]
        return seal(unit, struct.pack(f">BB{count}H", function, 2 * count, *words))
    if function == 16:
        return seal(unit, frame[1:6])
    if function in (5, 6, 8):
        return frame
    return seal(unit, bytes((function | 0x80, 1)))


class ScriptedSlave:
    """Answers in order, as a slave does. `("late", n)`: the answer comes just before that to the n-th next request."""

    def __init__(self) -> None:
        self.script: Script = always_ok
        self.reply: Callable[[bytes], bytes] = answer
        self.requests: list[bytes] = []
        self._held: list[tuple[int, bytes]] = []
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._wake_r, self._wake_w = os.pipe()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def say(self, data: bytes) -> None:
        """Speaks unasked."""
        os.write(self._master, data)

    def hang_up(self) -> None:
        os.write(self._wake_w, b"x")
        self._thread.join(2.0)
        for fd in (self._master, self._slave):
            if fd >= 0:
                os.close(fd)
        self._master = self._slave = -1

    def close(self) -> None:
        if self._master >= 0:
            self.hang_up()
        os.close(self._wake_r)
        os.close(self._wake_w)

    def _serve(self) -> None:
        data = b""
        while True:
            ready, _, _ = select.select([self._master, self._wake_r], [], [])
            if self._wake_r in ready:
                return
            data += os.read(self._master, 4096)
            while (size := request_size(data)) and len(data) >= size:
                frame, data = data[:size], data[size:]
                if crc16(frame) == 0:
                    self._handle(frame)

    def _handle(self, frame: bytes) -> None:
        index = len(self.requests)
        self.requests.append(frame)
        fault = self.script(index, frame)
        reply = self.reply(frame)
        due = b"".join(held for when, held in self._held if when <= index)
        self._held = [(when, held) for when, held in self._held if when > index]
        if fault[0] == "late" or self._held:  # nothing overtakes an answer that is still on its way
            wait = int(str(fault[1])) if fault[0] == "late" else 0
            last = max([index + wait, *(when for when, _ in self._held)])
            self._held.append((last, reply))
            reply = b""
        os.write(self._master, due + self._spoil(fault, reply, frame))

    @staticmethod
    def _spoil(fault: Fault, reply: bytes, frame: bytes) -> bytes:
        kind = fault[0]
        if kind == "noise":
            return bytes(fault[1]) + reply  # type: ignore[call-overload, no-any-return]
        if kind == "after":
            return reply + bytes(fault[1])  # type: ignore[call-overload, no-any-return]
        if kind == "flip" and reply:
            bit = int(str(fault[1])) % (8 * len(reply))
            spoilt = bytearray(reply)
            spoilt[bit // 8] ^= 1 << bit % 8
            return bytes(spoilt)
        if kind == "truncate":
            return reply[: -int(str(fault[1]))]
        if kind == "echo":
            return frame + reply
        if kind == "raw":
            return bytes(fault[1])  # type: ignore[call-overload, no-any-return]
        return b"" if kind == "drop" else reply


@pytest.fixture
def slave() -> Iterator[ScriptedSlave]:
    device = ScriptedSlave()
    yield device
    device.close()
