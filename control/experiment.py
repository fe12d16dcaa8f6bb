"""An experiment as a value: what to command and for how long; checked when made, previewed without hardware.

Levels are in the unit of the bench's command (`unit`: "psi", or "percent" on the pilot positioner), times in seconds.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from control.step import Step
from hal.errors import BadInput
from logs.recording import FloatArray


def level(default: float, doc: str) -> Any:
    """A field that is a command: anywhere on the command's scale."""
    return field(default=default, metadata={"is": "level", "doc": doc})


def span(default: float, doc: str, *, least: float = 1e-6) -> Any:
    """A field that is a difference of commands."""
    return field(default=default, metadata={"is": "span", "doc": doc, "least": least})


def rate(default: float, doc: str) -> Any:
    """A field that is a slope of the command, per second."""
    return field(default=default, metadata={"is": "span", "doc": doc, "least": 1e-6, "per_s": True})


def seconds(default: float, doc: str, *, least: float = 0.0, most: float = 1e6) -> Any:
    """A field that is a time."""
    return field(default=default, metadata={"is": "seconds", "doc": doc, "least": least, "most": most})


def number(default: float, doc: str, *, least: float, most: float) -> Any:
    """A field that is a number or a count; a whole default asks for whole numbers."""
    return field(default=default, metadata={"is": "number", "doc": doc, "least": least, "most": most})


@dataclass(frozen=True, kw_only=True)
class Experiment(ABC):
    """What every kind has in common. One kind is one file in `control/experiments`.

    Raises: `BadInput` naming the kind, the field, its value and its limit when made of impossible numbers.
    """

    unit: str = "psi"
    period_s: float = seconds(0.1, "time between two samples", least=1e-4, most=60.0)
    repeats: int = number(1, "how often the whole pass is repeated", least=1, most=10_000)
    seed: int = number(0, "seed of what is random in it", least=0, most=2**63 - 1)
    until_settled: bool = False
    conditioning: bool = True
    conditioning_low: float = level(4.0, "start and end of the conditioning stroke")
    conditioning_high: float = level(13.0, "far end of the conditioning stroke")
    conditioning_s: float = seconds(20.0, "stay at each end of the conditioning stroke", least=0.1)
    note: str = ""

    kind: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for each in fields(self):
            self._check(each.name, getattr(self, each.name), each.default, each.metadata)
        if self.conditioning_low >= self.conditioning_high:
            raise self.wrong("conditioning_low", self.conditioning_low, "must lie below conditioning_high")
        self.check()

    def _check(self, name: str, value: object, default: object, meta: Any) -> None:
        if isinstance(default, bool | str):
            if not isinstance(value, type(default)):
                raise self.wrong(name, value, "must be true or false" if isinstance(default, bool) else "must be text")
            return
        if "is" not in meta:
            return
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise self.wrong(name, value, "must be a finite number")
        if isinstance(default, int) and value != int(value):
            raise self.wrong(name, value, "must be a whole number")
        if value < meta.get("least", -math.inf):
            raise self.wrong(name, value, f"must be at least {meta['least']:g}")
        if value > meta.get("most", math.inf):
            raise self.wrong(name, value, f"must be at most {meta['most']:g}")

    def wrong(self, name: str, value: object, why: str) -> BadInput:
        """The sentence for a field that cannot be."""
        return BadInput(f"experiment {self.kind}: {name} = {value!r} {why}")

    def check(self) -> None:  # noqa: B027  (most kinds have nothing to add)
        """Raises `BadInput` where the fields of a kind do not go together."""

    @abstractmethod
    def one_pass(self) -> tuple[Step, ...]:
        """The steps of one pass, in order."""

    def steps(self) -> tuple[Step, ...]:
        """All steps, the repeats included, the conditioning stroke not."""
        once = self.one_pass()
        if not once:
            raise BadInput(f"experiment {self.kind}: there is no step in it; give it levels that differ")
        return once * int(self.repeats)

    def conditioning_steps(self) -> tuple[Step, ...]:
        """The stroke that wipes out what the valve remembers: down, up, down; empty when it is switched off."""
        if not self.conditioning:
            return ()
        low, high, stay_s = self.conditioning_low, self.conditioning_high, self.conditioning_s
        return tuple(Step(level, level, 0.0, stay_s, label="conditioning") for level in (low, high, low))

    @property
    def duration_s(self) -> float:
        """The longest time it takes [s], the conditioning stroke included."""
        return sum(step.duration_s for step in (*self.conditioning_steps(), *self.steps()))

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest command, the conditioning stroke included."""
        ends = [step.range() for step in (*self.conditioning_steps(), *self.steps())]
        return min(low for low, _ in ends), max(high for _, high in ends)

    def commands(self, period_s: float | None = None) -> Schedule:
        """What is commanded tick by tick when every step takes its longest; conditioning has step -1."""
        step_s = self.period_s if period_s is None else period_s
        conditioning, steps = self.conditioning_steps(), self.steps()
        values: list[float] = []
        indices: list[int] = []
        for number_, step in enumerate((*conditioning, *steps)):
            ticks = step.ticks(step_s)
            values += [step.at(tick * step_s) for tick in range(ticks)]
            indices += [max(-1, number_ - len(conditioning))] * ticks
        return Schedule(
            np.arange(len(values), dtype=np.float64) * float(step_s),
            np.array(values, dtype=np.float64),
            np.array(indices, dtype=np.int64),
        )


@dataclass(frozen=True, slots=True)
class Schedule:
    """An experiment tick by tick: arrays of shape (n,); `command[k]` goes out at `time_s[k]` and holds for a tick."""

    time_s: FloatArray
    command: FloatArray
    step: npt.NDArray[np.int64]
