"""A bench whose position reading comes late: a slow LVDT amplifier, a filter that only delays, a busy gateway."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from types import TracebackType
from typing import Self

from control.trial import Opened
from hal.bench import Bench, BenchInfo
from hal.sample import Sample


def with_late_gauge(opened: Opened, late_s: float) -> Opened:
    """An open bench with its position `late_s` late [s]; as it is for 0."""
    return replace(opened, bench=LateGauge(opened.bench, late_s)) if late_s else opened


class LateGauge:
    """Implements `hal.bench.Bench`: another bench with its position as it was `late_s` ago, pressure as it is.

    Between two samples it interpolates; before the first one it gives the first. Meant for virtual benches: quality
    and latency are those of the present reading.
    """

    def __init__(self, bench: Bench, late_s: float) -> None:
        self.bench = bench
        self.late_s = late_s
        self._seen: deque[tuple[float, float]] = deque()

    @property
    def info(self) -> BenchInfo:
        return self.bench.info

    def __enter__(self) -> Self:
        self.bench.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.bench.__exit__(kind, error, trace)

    def exchange(self, command_psi: float) -> Sample:
        sample = self.bench.exchange(command_psi)
        then_s = sample.time_s - self.late_s
        self._seen.append((sample.time_s, sample.position.value))
        while len(self._seen) >= 2 and self._seen[1][0] <= then_s + 1e-9:
            self._seen.popleft()
        return replace(sample, position=replace(sample.position, value=self._at(then_s)))

    def make_safe(self, reason: str) -> bool:
        return self.bench.make_safe(reason)

    def _at(self, then_s: float) -> float:
        (before_s, before), (after_s, after) = self._seen[0], self._seen[min(1, len(self._seen) - 1)]
        if then_s <= before_s or after_s <= before_s:
            return before
        return before + (after - before) * min((then_s - before_s) / (after_s - before_s), 1.0)
