"""One signal of a device as its profile describes it: where it lives, what its counts mean, and who says so."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from hal.words import RANGE, NumberType, WordOrder, decode, encode, word_count

Verified = Literal["hardware", "manual", "unverified"]
AS_LIST = Field(strict=False)  # a file has lists where we have tuples; what is in them is still looked at strictly
Span = Annotated[tuple[float, float], AS_LIST]


def _no_bool(value: Any) -> Any:
    if isinstance(value, bool):
        raise ValueError(f"{str(value).lower()} is not a whole number")
    return value


NO_BOOL = BeforeValidator(_no_bool)  # for a choice of numbers: there Python takes true for 1


class Part(BaseModel):
    """Base of everything in a profile: fixed once read, and a key that nobody knows is an error.

    Strict: "38400" and true are no numbers, whatever could be made of them.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class Transmitter(Part):
    """What stands between the module's terminal and the quantity: 4-20 mA for 3-15 psi, say."""

    signal: Span
    value: Span

    @model_validator(mode="after")
    def _check(self) -> Self:
        _distinct("signal", self.signal)
        _distinct("value", self.value)
        return self


class Register(Part):
    """A number in one or two registers.

    Counts become `eng` along the line through `raw` -> `eng`, then, through `transmitter`, the quantity in `unit`.
    `address` is as the manual prints it; the device's `address_base` says whether that counts from 0 or from 1.
    `sentinels` are raw counts that mean "no value"; NaN in a float always does. `plausible` is in `unit`.
    """

    address: Annotated[int, Field(ge=0, le=65536)]
    type: NumberType = "u16"
    device: str = ""  # the name of its device; the only one when there is only one
    table: Literal["holding", "input", "coil"] | None = None  # None: what the device's read_fc reads
    word_order: WordOrder | None = None  # None: the device's
    raw: Span | None = None
    eng: Span | None = None
    transmitter: Transmitter | None = None
    unit: str = ""
    sentinels: Annotated[tuple[int, ...], AS_LIST] = ()
    plausible: Span | None = None
    source: str = ""
    verified: Verified = "unverified"

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.raw is None) != (self.eng is None):
            raise ValueError("raw and eng belong together: give both or neither")
        if self.raw is not None and self.eng is not None:
            _distinct("raw", self.raw)
            _distinct("eng", self.eng)
            low, high = RANGE[self.type]
            if min(self.raw) < low or max(self.raw) > high:
                raise ValueError(f"raw {list(self.raw)} does not fit into {self.type} ({low:g} to {high:g})")
        if self.plausible is not None and self.plausible[0] >= self.plausible[1]:
            raise ValueError(f"plausible {list(self.plausible)} must be [low, high]")
        return self

    @property
    def words(self) -> int:
        return word_count(self.type)

    def gain_offset(self) -> Span:
        """(gain, offset) of quantity = gain * counts + offset."""
        gain, offset = _line(self.raw, self.eng) if self.raw and self.eng else (1.0, 0.0)
        if self.transmitter is None:
            return gain, offset
        gain2, offset2 = _line(self.transmitter.signal, self.transmitter.value)
        return gain * gain2, offset * gain2 + offset2

    def counts(self, words: Sequence[int], order: WordOrder) -> float:
        """The raw number, before any scaling; `order` is the device's, which the register's own overrides."""
        return decode(words, self.type, self.word_order or order)

    def is_sentinel(self, counts: float) -> bool:
        return math.isnan(counts) or counts in self.sentinels

    def is_saturated(self, counts: float) -> bool:
        """Whether the converter sits at an end of its type's range, where it may hide any value beyond."""
        return counts in RANGE[self.type] and self.type != "f32"

    def value(self, counts: float) -> float:
        """The quantity in `unit`."""
        gain, offset = self.gain_offset()
        return gain * counts + offset

    def to_words(self, value: float, order: WordOrder) -> tuple[int, ...]:
        """The registers that hold a quantity. Raises: `ValueError` when the type cannot."""
        gain, offset = self.gain_offset()
        return encode((value - offset) / gain, self.type, self.word_order or order)

    def resolution(self) -> float:
        """The quantity of one count; 0 for a float."""
        return 0.0 if self.type == "f32" else abs(self.gain_offset()[0])


def _line(x: Span, y: Span) -> Span:
    gain = (y[1] - y[0]) / (x[1] - x[0])
    return gain, y[0] - gain * x[0]


def _distinct(name: str, span: Span) -> None:
    if not all(math.isfinite(end) for end in span):
        raise ValueError(f"{name} {list(span)} must be finite")
    if span[0] == span[1]:
        raise ValueError(f"{name} {list(span)} is an impossible scale: both ends are the same")
