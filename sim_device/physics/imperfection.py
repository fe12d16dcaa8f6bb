"""What can be wrong with a virtual valve: the claim, its natural unit, its sizes and its alternative forms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.errors import BadInput

STAGES = ("ep", "actuator", "sensor")


@dataclass(frozen=True, slots=True)
class Imperfection:
    """One fault that a plant can have; size 0 is exactly the healthy plant.

    `sizes` are small, medium and large [unit], chosen so that the position differs from the healthy one by about
    2, 6 and 20 times the reading noise over a mixed sweep, as far as the mechanism can do that.
    `forms` are the laws that physics knows for it; the first is the default. `scales` are the factors on `sizes` with
    which the forms do about as much (none: all 1). Sizes go from -`limit` (`lowest`, where that is nearer) to `limit`.
    `outsider` marks a fault that no effect
    of the shared vocabulary describes; without `spread`, sizes must be used as they are because little more or less
    does nothing or everything.
    """

    name: str
    stage: str
    unit: str
    sizes: tuple[float, float, float]
    claim: str
    forms: tuple[str, ...] = ("default",)
    scales: tuple[float, ...] = ()
    limit: float = float("inf")
    lowest: float = -float("inf")
    signed: bool = False
    outsider: bool = False
    spread: bool = True
    source: str = ""

    def size(self, grade: int, form: str = "") -> float:
        """The small (0), medium (1) or large (2) size in `form`, the default one if empty [unit]."""
        scale = self.scales[self.forms.index(form)] if self.scales and form else 1.0
        return self.sizes[grade] * scale

    def within(self, size: float) -> float:
        """The nearest size that there can be [unit]."""
        return max(self.lowest, -self.limit, min(size, self.limit))


@dataclass(frozen=True, slots=True)
class Chosen:
    """An imperfection that is switched on: its size in the imperfection's unit and the number of its form."""

    imperfection: Imperfection
    size: float
    form: int


def choose(known: Sequence[Imperfection], effects: Mapping[str, float]) -> list[Chosen]:
    """Reads `{"stiction": 0.4, "creep/log": 0.1}`: names with an optional form after a slash, and sizes.

    Raises: `BadInput` for an unknown name or form, or a size that is not possible.
    """
    by_name = {item.name: item for item in known}
    chosen = []
    for key, size in effects.items():
        name, _, form = key.partition("/")
        if name not in by_name:
            raise BadInput(f"effect '{name}' is not known to this plant; it knows {', '.join(sorted(by_name))}")
        item = by_name[name]
        if form and form not in item.forms:
            raise BadInput(f"effect '{name}' has no form '{form}'; it has {', '.join(item.forms)}")
        if not np.isfinite(size) or abs(size) > item.limit or (size < 0.0 and not item.signed):
            low = -item.limit if item.signed else 0.0
            raise BadInput(f"effect '{name}': size {size} {item.unit} is outside {low:g} to {item.limit:g} {item.unit}")
        chosen.append(Chosen(item, float(size), item.forms.index(form) if form else 0))
    return chosen


def fields(known: Sequence[Imperfection]) -> list[tuple[str, str]]:
    """Two fields of the settings record per imperfection: `name` (its size) and `name_form` (number of its form)."""
    return [entry for item in known for entry in ((item.name, "f8"), (f"{item.name}_form", "i8"))]


def write(settings: NDArray[np.void], chosen: Sequence[Chosen]) -> None:
    """Sets size and form of what was chosen in a settings record (shape (1,)); the rest stays 0, which is healthy."""
    for item in chosen:
        settings[item.imperfection.name] = item.size
        settings[f"{item.imperfection.name}_form"] = item.form
