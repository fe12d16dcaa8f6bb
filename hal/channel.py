"""Words into one reading: a register of the profile, compiled once so that a tick only multiplies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hal.profile import Profile
from hal.register import Register
from hal.sample import Quality, Reading
from hal.words import WordOrder


@dataclass(frozen=True, slots=True)
class Channel:
    """A signal and where in its block of words it stands."""

    name: str
    register: Register
    order: WordOrder
    offset: int
    gain: float
    bias: float
    convert: Callable[[float], float] | None = None  # scaled register to the quantity (the LVDT's calibration)

    def value(self, words: Sequence[int]) -> tuple[float, Quality]:
        """The quantity, NaN for a sentinel, and what is wrong with it."""
        register = self.register
        counts = register.counts(words[self.offset : self.offset + register.words], self.order)
        if register.is_sentinel(counts):
            return math.nan, Quality.SENTINEL
        quality = Quality.SATURATED if register.is_saturated(counts) else Quality.GOOD
        value = self.gain * counts + self.bias
        if register.plausible and not register.plausible[0] <= value <= register.plausible[1]:
            quality |= Quality.IMPLAUSIBLE
        return (self.convert(value) if self.convert else value), quality

    def reading(self, words: Sequence[int], time_s: float, latency_s: float, extra: Quality) -> Reading:
        value, quality = self.value(words)
        return Reading(value, time_s, latency_s, quality | extra)


def channel(profile: Profile, name: str, register: Register, offset: int) -> Channel:
    """Compiles a register that stands at `offset` in its block."""
    gain, bias = register.gain_offset()
    convert = profile.position_in if name == "position" and profile.calibration else None
    return Channel(name, register, profile.device_of(register).word_order, offset, gain, bias, convert)
