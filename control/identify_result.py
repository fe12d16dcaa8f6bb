"""What an identification found: numbers with intervals, the design model made of them, and what it has to say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Literal

import numpy as np

from control.design import DesignModel
from control.identify_interval import Interval
from logs.recording import FloatArray

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
    of the position's variation that is explained, 100 (1 - |y - x| / |y - mean y|) [percent]."""

    rms: float
    rms_percent_of_travel: float
    fit_percent: float


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

    def to_plain(self) -> Mapping[str, object]:
        """Everything but the predictions, as plain values."""
        return {
            "runs": list(self.runs),
            "rows": self.rows,
            "estimates": {each.name: each.to_plain() for each in self.estimates},
            "fit": asdict(self.quality),
            "notes": list(self.notes),
        }


def quality_of(residual: FloatArray, position: FloatArray, travel: float) -> Quality:
    """`residual` and `position` are good rows only, shape (n,)."""
    rms = float(np.sqrt(np.mean(residual**2)))
    spread = float(np.linalg.norm(position - position.mean()))
    explained = 100.0 * (1.0 - float(np.linalg.norm(residual)) / spread) if spread > 0.0 else float("nan")
    return Quality(rms, 100.0 * rms / travel, explained)
