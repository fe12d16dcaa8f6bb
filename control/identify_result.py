"""What an identification found: numbers with intervals, the design model made of them, and what it has to say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Literal

import numpy as np

from control.design import DesignModel
from control.identify_interval import Interval
from control.identify_readings import fast_noise
from logs.recording import FloatArray
from logs.spoken import Spoken

# A residual so many times the noise, and of so much of travel, is no noise; a healthy valve's stays within twice of it.
MISFIT_NOISES = 5.0
MISFIT_PERCENT = 0.5
Source = Literal["fit", "curves", "63 % rule", "kept"]


@dataclass(frozen=True, slots=True)
class Estimate:
    """One number. `interval` is None where the record does not tell, and `value` is then the default that was kept."""

    name: str
    value: float
    interval: Interval | None
    unit: str
    source: Source
    note: str = ""

    def to_plain(self) -> dict[str, object]:
        ci95 = None if self.interval is None else [self.interval.low, self.interval.high]
        plain: dict[str, object] = {"value": self.value, "ci95": ci95, "unit": self.unit, "source": self.source}
        return plain | ({"note": self.note} if self.note else {})


@dataclass(frozen=True, slots=True)
class Quality:
    """How well the model fits: RMS of the residual, in the position's unit and in percent of travel, and the share
    of the position's variation that is explained, 100 (1 - |y - x| / |y - mean y|) [percent].

    `commanded_percent_of_travel` is the RMS where the model makes the pressure of the command, as it does in use, and
    not of the gauge; None where no pressure was measured.
    """

    rms: float
    rms_percent_of_travel: float
    fit_percent: float
    commanded_percent_of_travel: float | None = None


@dataclass(frozen=True)
class Identified:
    """`design` is what goes into the model file; `estimates` are all numbers, also those by other ways."""

    design: DesignModel
    estimates: tuple[Estimate, ...]
    quality: Quality
    runs: tuple[str, ...]
    rows: int
    notes: tuple[str, ...] = ()
    predictions: tuple[FloatArray, ...] = field(default=(), repr=False)

    def __getitem__(self, name: str) -> Estimate:
        """The estimate of that name. Raises: `KeyError`."""
        return next(each for each in self.estimates if each.name == name) if name in self.names else self._missing(name)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(each.name for each in self.estimates)

    def _missing(self, name: str) -> Estimate:
        raise KeyError(name)

    def answered(self) -> Identified:
        """The same as who asks reads it: numbers and the residual in the units in which the design is spoken of."""
        spoken = self.design.spoken
        rms = spoken.value(self.quality.rms, self.design.position_unit)
        said = tuple(_answered(each, spoken) for each in self.estimates)
        return replace(self, estimates=said, quality=replace(self.quality, rms=rms))

    def to_plain(self) -> Mapping[str, object]:
        """Everything but the predictions, as plain values."""
        return {
            "runs": list(self.runs),
            "rows": self.rows,
            "estimates": {each.name: each.to_plain() for each in self.estimates},
            "fit": asdict(self.quality),
            "notes": list(self.notes),
        }


def _answered(each: Estimate, spoken: Spoken) -> Estimate:
    interval = each.interval
    if interval is not None:
        interval = Interval(*(spoken.value(v, each.unit) for v in (interval.value, interval.low, interval.high)))
    return replace(each, value=spoken.value(each.value, each.unit), interval=interval, unit=spoken.unit(each.unit))


def quality_of(residual: FloatArray, position: FloatArray, travel: float) -> Quality:
    """`residual` and `position` are good rows only, shape (n,)."""
    rms = float(np.sqrt(np.mean(residual**2)))
    spread = float(np.linalg.norm(position - position.mean()))
    explained = 100.0 * (1.0 - float(np.linalg.norm(residual)) / spread) if spread > 0.0 else float("nan")
    return Quality(rms, 100.0 * rms / travel, explained)


def misfit(quality: Quality, positions: Sequence[FloatArray]) -> tuple[str, ...]:
    """A warning where the model clearly does not fit its own record: the intervals hold for a model that is right.

    The steps of a coarse reading count as its noise, and values that are shown again and again as one.
    """
    noise = max(max(fast_noise(each), fast_noise(_new(each)), _step(each) / 12.0**0.5) for each in positions)
    if quality.rms_percent_of_travel < MISFIT_PERCENT or quality.rms < MISFIT_NOISES * noise:
        return ()
    times = f"by {quality.rms / noise:.2g} times its noise" if noise > 0.0 else "although it is free of noise"
    return (
        f"the model misses this record {times} (RMS {quality.rms_percent_of_travel:.2g} % of travel); "
        "the intervals do not cover that: something is at work that the model does not know; run lostmotion diagnose",
    )


def _new(values: FloatArray) -> FloatArray:
    """The readings that are not the ones before."""
    known = values[np.isfinite(values)]
    return known[np.flatnonzero(np.diff(known)) + 1]


def _step(values: FloatArray) -> float:
    """The smallest distance between two different readings."""
    distances = np.diff(np.unique(values[np.isfinite(values)]))
    return float(distances.min()) if distances.size else 0.0
