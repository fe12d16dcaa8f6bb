"""Numbers into 16-bit registers and back, in every type and order that devices use.

Kept apart from the master's decoder on purpose, like the checksum.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence

_FORMAT = {"bit": ">H", "u16": ">H", "i16": ">h", "u32": ">I", "i32": ">i", "f32": ">f", "f64": ">d", "u64": ">Q"}
_INTEGER_RANGE = {
    "bit": (0, 1),
    "u16": (0, 0xFFFF),
    "i16": (-0x8000, 0x7FFF),
    "u32": (0, 0xFFFFFFFF),
    "i32": (-0x80000000, 0x7FFFFFFF),
    "u64": (0, 0xFFFFFFFFFFFFFFFF),
}


def width(kind: str) -> int:
    """How many registers a number of this kind takes."""
    return struct.calcsize(_FORMAT[kind]) // 2


def encode(value: float, kind: str, order: str = "ABCD") -> list[int]:
    """`value` as registers. Integers are rounded and stop at the ends of their range, as a converter does.

    `order` names the bytes as they appear on the wire: ABCD (big), CDAB (words swapped), BADC (bytes swapped), DCBA.
    """
    limits = _INTEGER_RANGE.get(kind)
    if limits is None:
        raw = struct.pack(_FORMAT[kind], value)
    else:
        low, high = limits
        raw = struct.pack(_FORMAT[kind], low if math.isnan(value) else min(max(round(value), low), high))
    return list(struct.unpack(f">{len(raw) // 2}H", _reordered(raw, order)))


def decode(words: Sequence[int], kind: str, order: str = "ABCD") -> float:
    """The number in these registers; the inverse of `encode`."""
    raw = _reordered(struct.pack(f">{len(words)}H", *words), order)
    return float(struct.unpack(_FORMAT[kind], raw)[0])


def _reordered(raw: bytes, order: str) -> bytes:
    """Every order is its own inverse, so this serves both ways."""
    if order == "ABCD":
        return raw
    words = [raw[at : at + 2] for at in range(0, len(raw), 2)]
    if order in ("BADC", "DCBA"):
        words = [word[::-1] for word in words]
    if order in ("CDAB", "DCBA"):
        words.reverse()
    return b"".join(words)
