"""What the LVDT's signal means in inches: two points, or a table."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from datetime import date
from typing import Annotated, Self

from pydantic import Field, model_validator

from hal.register import AS_LIST, Part, Span

Day = Annotated[date, Field(strict=False)]  # a day in quotes is as clear as one without


class Calibration(Part):
    """A table of (signal, position [in]), straight between its points and, beyond its ends, on along the last segment.

    Two points are the usual two-point calibration. Both columns must rise or fall strictly.
    """

    id: str
    made: Day
    expires: Day | None = None
    instrument: str = ""
    points: Annotated[tuple[Span, ...], Field(min_length=2), AS_LIST]

    @model_validator(mode="after")
    def _check(self) -> Self:
        for column, name in ((0, "signal"), (1, "position")):
            steps = [b[column] - a[column] for a, b in zip(self.points, self.points[1:], strict=False)]
            if not (all(step > 0 for step in steps) or all(step < 0 for step in steps)):
                raise ValueError(f"the {name} column of points must rise or fall strictly; sort the rows")
        if self.expires is not None and self.expires < self.made:
            raise ValueError(f"expires ({self.expires}) lies before made ({self.made})")
        return self

    def to_in(self, signal: float) -> float:
        """The position [in] of a signal, in the unit of the register's `eng`."""
        return _interpolate([p[0] for p in self.points], [p[1] for p in self.points], signal)

    def to_signal(self, position_in: float) -> float:
        """The signal of a position [in]; the inverse of `to_in`."""
        return _interpolate([p[1] for p in self.points], [p[0] for p in self.points], position_in)

    def expired(self, today: date) -> bool:
        return self.expires is not None and today > self.expires

    def warning(self, today: date) -> str | None:
        """One sentence for who is about to rely on positions; None while the calibration counts."""
        if not self.expired(today):
            return None
        return (
            f"calibration '{self.id}' expired on {self.expires}: positions may be off; `lostmotion calibrate` renews it"
        )


def _interpolate(x: Sequence[float], y: Sequence[float], at: float) -> float:
    if x[0] > x[-1]:
        x, y = x[::-1], y[::-1]
    i = min(max(bisect_right(x, at) - 1, 0), len(x) - 2)
    return y[i] + (y[i + 1] - y[i]) * (at - x[i]) / (x[i + 1] - x[i])
