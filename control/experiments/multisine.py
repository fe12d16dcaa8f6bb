"""A sum of sines with random phases: a flat spectrum between two frequencies, and reversals of every size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from control.experiment import Experiment, level, number, seconds, span
from control.step import Step, Tone

TRIES = 50


@dataclass(frozen=True, kw_only=True)
class Multisine(Experiment):
    """All odd harmonics of 1 / `base_s` up to `highest_hz`, amplitudes falling as 1 / sqrt(f), around `centre`.

    The sum stays within `amplitude` of the centre. Of 50 draws of phases that with the lowest crest factor is taken.
    One step is one period, so that periods can be compared with each other.
    Source: random-phase odd multisine, Pintelon and Schoukens, "System Identification", 2nd edition, 2012.
    """

    kind: ClassVar[str] = "multisine"
    centre: float = level(8.7, "mean")
    amplitude: float = span(4.3, "largest distance from the mean")
    base_s: float = seconds(200.0, "period of the lowest tone", least=0.1)
    highest_hz: float = number(0.1, "highest frequency", least=1e-6, most=1e3)
    periods: int = number(3, "number of periods", least=1, most=10_000)

    def check(self) -> None:
        if self.highest_hz * self.base_s < 1.0:
            raise self.wrong("highest_hz", self.highest_hz, f"is below the lowest tone, {1.0 / self.base_s:g} Hz")
        if self.highest_hz * self.period_s > 0.5:
            raise self.wrong("highest_hz", self.highest_hz, f"needs a period_s of {0.5 / self.highest_hz:g} s or less")

    def tones(self) -> tuple[Tone, ...]:
        chance = np.random.default_rng(int(self.seed))
        frequencies_hz = np.arange(1.0, self.highest_hz * self.base_s + 1e-9, 2.0) / self.base_s
        shape = frequencies_hz**-0.5
        phases_rad = chance.uniform(0.0, 2.0 * np.pi, (TRIES, frequencies_hz.size))
        samples = max(256, 16 * int(self.highest_hz * self.base_s))
        angle = 2.0 * np.pi * np.outer(frequencies_hz, np.linspace(0.0, self.base_s, samples, endpoint=False))
        peaks = [float(np.max(np.abs(shape @ np.sin(angle + phase[:, None])))) for phase in phases_rad]
        best = int(np.argmin(peaks))
        scale = self.amplitude / (1.01 * peaks[best])  # 1 % for what lies between the samples looked at
        return tuple(
            Tone(float(f), float(scale * a), float(phase))
            for f, a, phase in zip(frequencies_hz, shape, phases_rad[best], strict=True)
        )

    def one_pass(self) -> tuple[Step, ...]:
        period = Step(self.centre, self.centre, 0.0, self.base_s, tones=self.tones())
        return (period,) * int(self.periods)

    @property
    def range(self) -> tuple[float, float]:
        """The scaling of the tones holds the sum within `amplitude`, far closer than the sum of the amplitudes."""
        low, high = self.centre - self.amplitude, self.centre + self.amplitude
        if self.conditioning:
            low, high = min(low, self.conditioning_low), max(high, self.conditioning_high)
        return low, high


EXPERIMENT = Multisine
