"""One step of an experiment or of a target sequence: where the value goes, how fast, and how long it stays there."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Tone:
    """A sine that rides on a step: amplitude * sin(2 pi frequency_hz t + phase_rad), t from the start of the step."""

    frequency_hz: float
    amplitude: float
    phase_rad: float

    def at(self, elapsed_s: float) -> float:
        return self.amplitude * math.sin(2.0 * math.pi * self.frequency_hz * elapsed_s + self.phase_rad)


@dataclass(frozen=True, slots=True)
class Step:
    """Goes straight from `start` to `end` in `rise_s`, then stays for `hold_s`. Values in the unit of their owner.

    With `until_settled` the stay ends as soon as the valve has settled, and `hold_s` is its longest length.
    """

    start: float
    end: float
    rise_s: float = 0.0
    hold_s: float = 0.0
    tones: tuple[Tone, ...] = ()
    until_settled: bool = False
    label: str = ""

    @property
    def duration_s(self) -> float:
        """The longest time this step takes [s]."""
        return self.rise_s + self.hold_s

    def ticks(self, period_s: float) -> int:
        """How many ticks of `period_s` it takes at the longest; at least one."""
        return max(1, round(self.duration_s / period_s))

    def at(self, elapsed_s: float) -> float:
        """The value `elapsed_s` after the start of the step."""
        share = 1.0 if elapsed_s >= self.rise_s else elapsed_s / self.rise_s
        return self.start + share * (self.end - self.start) + sum(tone.at(elapsed_s) for tone in self.tones)

    def range(self) -> tuple[float, float]:
        """Bounds that the value stays within."""
        room = sum(abs(tone.amplitude) for tone in self.tones)
        return min(self.start, self.end) - room, max(self.start, self.end) + room


def joined(levels: tuple[float, ...], start: float, *, rise_s: float, hold_s: float, until_settled: bool) -> list[Step]:
    """Steps through `levels`, each reached from the last (the first from `start`) in `rise_s` and held for `hold_s`."""
    befores = (start, *levels[:-1])
    return [
        Step(before, level, rise_s, hold_s, until_settled=until_settled)
        for before, level in zip(befores, levels, strict=True)
    ]


def turning_points(values: list[float]) -> list[float]:
    """The extremes that a play still remembers after going through `values`, oldest first, the last value at the end.

    Smaller swings inside a later larger one are forgotten. Going through the result from far below, where every play
    is saturated, brings a play, or any spread of plays, to the same state as going through all of `values` from there.
    Source: return-point memory and wiping-out, Mayergoyz, "Mathematical Models of Hysteresis", Springer 1991, ch. 1.
    """
    kept = [-math.inf]
    for value in values:
        while len(kept) >= 2 and (value - kept[-1]) * (kept[-1] - kept[-2]) >= 0.0:
            kept.pop()
        while len(kept) >= 3 and abs(value - kept[-1]) >= abs(kept[-1] - kept[-2]):
            del kept[-2:]
        kept.append(value)
    return kept[1:]
