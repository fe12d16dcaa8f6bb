"""One tick of the bench, as the rest of the house sees it: engineering units, times, quality; no registers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntFlag


class Quality(IntFlag):
    """What is wrong with a reading; 0 is good. Recorded as an integer, so values never change their meaning."""

    GOOD = 0
    STALE = 1  # the device's sequence register did not advance: a value seen before
    SENTINEL = 2  # the device says "no value" (for example 0xFFFF or NaN)
    IMPLAUSIBLE = 4  # outside the physical range of the signal
    SATURATED = 8  # at the end of the converter's range
    MISSING = 16  # no reply could be trusted in this tick; the value is NaN
    RESTARTED = 32  # the sequence register jumped: the device has restarted


@dataclass(frozen=True, slots=True)
class Reading:
    """One signal. `time_s` is the midpoint of its transaction in bench time, `latency_s` its whole length."""

    value: float
    time_s: float
    latency_s: float
    quality: Quality = Quality.GOOD


@dataclass(frozen=True, slots=True)
class Sample:
    """What one `Bench.exchange` brought back.

    `commanded_psi` is the command that this exchange wrote (after limits); it is in force from `time_s` on.
    `readback_psi` is the command register as the device holds it after the write, where the device can tell.
    `foreign_psi` is what it held just before, where that was looked at and was not what it had been sent last.
    `pressure` is None on a bench without a pressure reading. `aux` holds extra channels by name (supply_psi, ...).
    """

    time_s: float
    commanded_psi: float
    position: Reading
    pressure: Reading | None = None
    readback_psi: float | None = None
    foreign_psi: float | None = None
    sequence: int | None = None
    aux: Mapping[str, Reading] = field(default_factory=dict)
