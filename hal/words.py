"""16-bit registers into numbers and back, in the four word orders that devices use."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Literal

NumberType = Literal["u16", "i16", "u32", "i32", "f32"]
WordOrder = Literal["ABCD", "CDAB", "BADC", "DCBA"]

# The most and least raw value of every type; a float has no ends that a converter could sit at.
RANGE: dict[str, tuple[float, float]] = {
    "u16": (0.0, 65535.0),
    "i16": (-32768.0, 32767.0),
    "u32": (0.0, 4294967295.0),
    "i32": (-2147483648.0, 2147483647.0),
    "f32": (float("-inf"), float("inf")),
}
_CODE = {"u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f"}


def word_count(kind: NumberType) -> int:
    """How many 16-bit registers a number takes."""
    return 1 if kind in ("u16", "i16") else 2


def decode(words: Sequence[int], kind: NumberType, order: WordOrder = "ABCD") -> float:
    """The number in `words`; the letters of `order` name the bytes of a 32-bit value in the order of transmission.

    For 16-bit numbers only the order of the two bytes matters (`BADC` and `DCBA` swap them).
    """
    data = _ordered(struct.pack(f">{len(words)}H", *words), order)
    return float(struct.unpack(">" + _CODE[kind], data)[0])


def encode(value: float, kind: NumberType, order: WordOrder = "ABCD") -> tuple[int, ...]:
    """The registers that hold `value`; integers are rounded to the nearest.

    Raises: `ValueError` when the type cannot hold it.
    """
    try:
        packed = struct.pack(">" + _CODE[kind], value if kind == "f32" else round(value))
    except (struct.error, OverflowError) as error:
        raise ValueError(f"{value:g} does not fit into {kind}") from error
    return struct.unpack(f">{word_count(kind)}H", _ordered(packed, order))


def _ordered(data: bytes, order: WordOrder) -> bytes:
    """Moves bytes between the order of transmission and ABCD; every order is its own inverse."""
    if order in ("BADC", "DCBA"):
        data = b"".join(data[i + 1 : i + 2] + data[i : i + 1] for i in range(0, len(data), 2))
    if order in ("CDAB", "DCBA") and len(data) == 4:
        data = data[2:] + data[:2]
    return data
