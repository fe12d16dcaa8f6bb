"""The units in which somebody is answered, and the one place where an answer is brought into them.

All is computed in the house's units, psi and in (or percent). Who came with bar and mm is answered in bar and mm: a
conversion of what is said, by the units library, that no computation sees.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from logs.units import HOUSE_UNIT, PERCENT, Quantity, conversion, size_unit

if TYPE_CHECKING:
    from logs.recording import Recording

#: Words of a unit such as `in/psi` or `psi/s`.
_WORD = re.compile(r"[^/]+")
#: Digits that a converted number is written with where a machine reads it: none of them is an artefact of the factor.
_DIGITS = 12
#: Where a recording keeps the units in which its file was written: role -> unit.
WRITTEN = "written"


@dataclass(frozen=True, slots=True)
class Spoken:
    """The units of pressure and position in which sizes are said; a size in any other unit is said as it is."""

    pressure: str = HOUSE_UNIT["pressure"]
    position: str = HOUSE_UNIT["position"]

    @property
    def is_house(self) -> bool:
        """Whether nothing has to be converted."""
        return self == HOUSE

    def unit(self, unit: str) -> str:
        """What a unit of the house, like `in/psi`, becomes; any other unit is left alone."""
        words = {ours: f"({said})" if "/" in unit and "/" in said else said for ours, said in self._words.items()}
        return _WORD.sub(lambda word: words.get(word[0], word[0]), unit)

    def value(self, value: float, unit: str) -> float:
        """A number in a unit of the house, like `in/psi`, as it is said."""
        above, _, below = unit.partition("/")
        factor = self._factor(above) / self._factor(below)
        return value if factor == 1.0 else value * factor

    def written(self, value: float, unit: str) -> float:
        """The same for a file: without the last digits, which are the factor's rounding."""
        said = self.value(value, unit)
        return said if said == value else float(f"{said:.{_DIGITS}g}")

    def text(self, value: float, unit: str, digits: int) -> str:
        """Number and unit as said, with so many significant digits; the unit "1" is not said."""
        return f"{self.value(value, unit):.{digits}g} {'' if unit == '1' else self.unit(unit)}".rstrip()

    @property
    def _words(self) -> Mapping[str, str]:
        return {HOUSE_UNIT["pressure"]: self.pressure, HOUSE_UNIT["position"]: self.position}

    def _factor(self, word: str) -> float:
        said = self._words.get(word, word)
        if said == word:
            return 1.0
        return 1.0 / conversion(said, "pressure" if word == HOUSE_UNIT["pressure"] else "position").scale


HOUSE = Spoken()


def spoken_in(pressure: str, position: str) -> Spoken:
    """How somebody is answered who wrote these units in a header, an option or a model file.

    Of a signal with a range (`mA(4..20=0.2..1 bar)`) it is the unit of the range; an absolute pressure is said as a
    gauge's, in the same unit. Percent stay percent, so whatever is computed in them is said in them.
    """
    return Spoken(_said(pressure, "pressure"), _said(position, "position"))


def spoken_by(recordings: Sequence[Recording]) -> Spoken:
    """How the files of these recordings speak, if alike; runs on a bench of this house have no units to choose."""
    said = {
        spoken_in(str(units.get("command", "")), str(units.get("position", "")))
        for each in recordings
        if isinstance(units := each.meta.get(WRITTEN), Mapping)
    }
    return said.pop() if len(said) == 1 else HOUSE


def _said(text: str, quantity: Quantity) -> str:
    """The plain name of a unit; the house's own for what is the same, or is no unit that a size could be said in."""
    name, house = size_unit(text), HOUSE_UNIT[quantity]
    if name in ("", PERCENT, "fraction") or conversion(name, quantity).scale == 1.0:
        return house
    return name


def of_its_file(recording: Recording) -> Spoken:
    """The units in which the columns of a recording's file are, for what an operator has to say of them."""
    units = recording.meta.get(WRITTEN)
    written = [str(units.get(role, "")) for role in ("command", "position")] if isinstance(units, Mapping) else ["", ""]
    return spoken_in(*("" if "(" in unit else unit for unit in written))
