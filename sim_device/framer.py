"""Bytes into requests: where a Modbus RTU request ends, and how a slave finds its feet after noise.

A request is complete when its own length says so and its CRC agrees, so an undisturbed master never waits for a
silence. After `idle_reset_s` without a byte, whatever is left is searched once more for an intact request at any
offset, and then forgotten: one disturbance followed by silence loses no later request.
"""

from __future__ import annotations

from sim_device.crc import crc16

_FIXED_LENGTH = {1: 8, 2: 8, 3: 8, 4: 8, 5: 8, 6: 8, 7: 4, 8: 8, 11: 4, 12: 4, 17: 4, 22: 10, 24: 6, 43: 7}
_BYTE_COUNT_AT = {15: 6, 16: 6, 20: 2, 21: 2, 23: 10}  # offset of the byte count in the frame
_SHORTEST, _LONGEST = 4, 256


def request_length(frame: bytes | bytearray) -> int | None:
    """How long the request that starts with these bytes will be, CRC included; None while that cannot be known."""
    if len(frame) < 2:
        return None
    fixed = _FIXED_LENGTH.get(frame[1])
    if fixed is not None:
        return fixed
    at = _BYTE_COUNT_AT.get(frame[1])
    if at is None or len(frame) <= at:
        return None
    return at + 1 + frame[at] + 2


def rtu_idle_s(baud: int, bits_per_char: int = 10) -> float:
    """The silence that ends a frame, t3.5 [s]: 3.5 characters up to 19200 baud, 1.75 ms above.

    Source: Modbus over serial line V1.02, section 2.5.1.1.
    """
    return 3.5 * bits_per_char / baud if baud <= 19200 else 1.75e-3


class RequestFramer:
    """Holds the bytes that are not yet a request. Time is told from outside."""

    def __init__(self, idle_reset_s: float = 0.010) -> None:
        self.idle_reset_s = idle_reset_s
        self.discarded = 0  # bytes that belonged to no intact request
        self.damaged = 0  # disturbances: how often bytes had to be discarded
        self._buffer = bytearray()
        self._last_byte_s = 0.0

    @property
    def pending(self) -> bool:
        """Whether bytes wait for more bytes, or for the silence that discards them."""
        return bool(self._buffer)

    def feed(self, data: bytes, now_s: float) -> list[bytes]:
        """Takes bytes that arrived at `now_s` [s] and returns the intact requests, each with its CRC."""
        frames = self.idle(now_s)
        self._last_byte_s = now_s
        self._buffer += data
        return frames + self._take(hunt=False)

    def idle(self, now_s: float) -> list[bytes]:
        """Called when nothing arrived until `now_s` [s]; after a silence, searches what is left and forgets it."""
        if not self._buffer or now_s - self._last_byte_s < self.idle_reset_s:
            return []
        frames = self._take(hunt=True)
        self._discard(len(self._buffer))
        return frames

    def _take(self, *, hunt: bool) -> list[bytes]:
        frames: list[bytes] = []
        start = 0
        while start < len(self._buffer):
            state = _look(self._buffer[start:])
            if state > 0:
                if start:
                    self._discard(start)
                frames.append(bytes(self._buffer[:state]))
                del self._buffer[:state]
                start = 0
            elif state == 0 and not hunt:
                break  # the rest of this request may still be on its way
            else:
                start += 1
        if len(self._buffer) > _LONGEST and not hunt:
            self._discard(len(self._buffer) - _LONGEST)
        return frames

    def _discard(self, count: int) -> None:
        if count:
            self.discarded += count
            self.damaged += 1
            del self._buffer[:count]


def _look(data: bytearray) -> int:
    """Length of the intact request at the start of `data`, 0 when more bytes are needed, -1 when there is none."""
    length = request_length(data)
    if length is not None and length <= len(data):
        if crc16(data[:length]) == 0:
            return length
        # Function 8 may carry any number of data bytes, so a whole chunk that checks is a request as well.
        return len(data) if data[1] == 8 and crc16(data) == 0 else -1
    if length is None and _SHORTEST <= len(data) <= _LONGEST and crc16(data) == 0:
        return len(data)  # a function this slave does not know, answered with exception 1
    return 0 if length is None or length <= _LONGEST else -1
