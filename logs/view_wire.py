"""What goes through the pipe from a run to its live view: rows and events as frames that are written whole.

A frame is at most `select.PIPE_BUF` bytes long, so that a write to the pipe takes all of it or nothing.
"""

from __future__ import annotations

import json
import select
import struct
from collections.abc import Iterator
from dataclasses import asdict, replace

from logs.run import Event

Row = tuple[float, ...]

_HEAD = struct.Struct("<cI")
_ROW, _EVENT = b"r", b"e"
_CUT = " ..."


def pack_row(row: Row) -> bytes:
    """One row of float64. Raises: `ValueError` when it has more columns than a frame can hold."""
    body = struct.pack(f"<{len(row)}d", *row)
    if len(body) + _HEAD.size > select.PIPE_BUF:
        raise ValueError(f"{len(row)} columns are more than a live view can take at once")
    return _HEAD.pack(_ROW, len(body)) + body


def pack_event(event: Event) -> bytes:
    """One event; a text that is too long is cut."""
    body = json.dumps(asdict(event)).encode()
    kept = event.text
    while len(body) + _HEAD.size > select.PIPE_BUF:  # a character is one byte of JSON, or twelve
        kept = kept[: len(kept) * 3 // 4]
        body = json.dumps(asdict(replace(event, text=kept + _CUT))).encode()
    return _HEAD.pack(_EVENT, len(body)) + body


class Unpacker:
    """Turns the bytes of the pipe, however they are cut, into rows and events again."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[Row | Event]:
        """Everything that is complete by now."""
        self._rest += data
        at = 0
        while len(self._rest) - at >= _HEAD.size:
            kind, size = _HEAD.unpack_from(self._rest, at)
            begin, end = at + _HEAD.size, at + _HEAD.size + size
            if len(self._rest) < end:
                break
            body = self._rest[begin:end]
            yield struct.unpack(f"<{size // 8}d", body) if kind == _ROW else Event(**json.loads(body))
            at = end
        self._rest = self._rest[at:]
