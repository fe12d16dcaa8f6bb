"""Units of foreign columns, turned into the house's own: psi, in, s, or percent where the file knows no more.

A unit is a name that the units library knows (kPa, mbar, mm, ms, degF), `percent`, `fraction`, or a signal with its
range: `percent(3..15 psi)`, `mA(4..20=3..15 psi)`, `V(0..5=0..0.5625 in)`. The house's pressure is a gauge's: from an
absolute one (psia, bara, kPaa) the standard atmosphere is taken off.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Literal

from hal.errors import BadInput

if TYPE_CHECKING:
    import pint

Quantity = Literal["time", "pressure", "position"]
HOUSE_UNIT: dict[Quantity, str] = {"time": "s", "pressure": "psi", "position": "in"}
PERCENT = "percent"
_ATMOSPHERE_PSI = 14.696

_ALIASES = {
    "psig": "psi",
    "psi(g)": "psi",
    "barg": "bar",
    "bar(g)": "bar",
    "kpag": "kPa",
    "kpa": "kPa",
    "mpa": "MPa",
    "pa": "Pa",
    "inches": "inch",
    "in.": "inch",
    '"': "inch",
    "sec": "s",
    "secs": "s",
    "seconds": "s",
    "msec": "ms",
    "µs": "us",
    "usec": "us",
    "%": PERCENT,
    "pct": PERCENT,
    "perc": PERCENT,
    "frac": "fraction",
    "1": "fraction",
    "-": "",
}
_ABSOLUTE = {
    "psia": "psi",
    "psi(a)": "psi",
    "bara": "bar",
    "bar(a)": "bar",
    "mbara": "mbar",
    "kpaa": "kPa",
    "kpa(a)": "kPa",
    "mpaa": "MPa",
}
_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
_RANGE = re.compile(
    rf"(?P<signal>[^()\s]+)\s*\((?:(?P<a>{_NUMBER})\.\.(?P<b>{_NUMBER})\s*=\s*)?"
    rf"(?P<c>{_NUMBER})\.\.(?P<d>{_NUMBER})\s*(?P<unit>[^()\s]+)\)"
)


@dataclass(frozen=True, slots=True)
class Conversion:
    """House value = `scale` * file value + `shift`, in `unit`; `said` tells an operator what was done, if anything."""

    scale: float
    shift: float
    unit: str
    said: str = ""


@lru_cache(maxsize=256)
def conversion(text: str, quantity: Quantity) -> Conversion:
    """How a column in unit `text` becomes a column in house units.

    Raises: `BadInput` naming the unit when it is unknown, or is not one of that quantity.
    """
    house = HOUSE_UNIT[quantity]
    ranged = _RANGE.fullmatch(text.strip())
    if ranged is not None:
        return _from_range(ranged, text, quantity)
    name = plain_name(text)
    if name.lower() in _ABSOLUTE and quantity == "pressure":
        scale, _ = _affine(_ABSOLUTE[name.lower()], house, quantity, text)
        return Conversion(scale, -_ATMOSPHERE_PSI, house, f"converted from {text} to {house}{_taken_off(text)}")
    if name == house or not name:
        return Conversion(1.0, 0.0, house)
    if name in (PERCENT, "fraction") and quantity != "time":
        return Conversion(1.0 if name == PERCENT else 100.0, 0.0, PERCENT, "" if name == PERCENT else "fraction x 100")
    scale, shift = _affine(name, house, quantity, text)
    return Conversion(scale, shift, house, f"converted from {text} to {house}")


@cache
def atmosphere(unit: str) -> tuple[float, float]:
    """The atmosphere's absolute pressure in `unit`, and what a gauge in it reads there.

    Percent is taken for the usual 3 to 15 psi (IEC 60382).
    """
    if plain_name(unit) == PERCENT:
        return 100.0 * (_ATMOSPHERE_PSI / 12.0), -25.0
    return _ATMOSPHERE_PSI / conversion(unit, "pressure").scale, 0.0


def is_unit(text: str, quantity: Quantity) -> bool:
    """Whether `text` is a unit of that quantity; for finding units in headers."""
    if not plain_name(text):
        return False
    try:
        conversion(text, quantity)
    except BadInput:
        return False
    return True


def plain_name(text: str) -> str:
    """The unit's name as the units library spells it."""
    name = text.strip()
    return _ALIASES.get(name.lower(), name)


def size_unit(text: str) -> str:
    """The unit in which a size is said where a column is in `text`: of a range its own, of an absolute pressure the
    gauge's."""
    ranged = _RANGE.fullmatch(text.strip())
    name = plain_name(ranged["unit"] if ranged is not None else text)
    return _ABSOLUTE.get(name.lower(), name)


def _from_range(found: re.Match[str], text: str, quantity: Quantity) -> Conversion:
    signal = plain_name(found["signal"])
    if found["a"] is None:
        if signal not in (PERCENT, "fraction"):
            raise BadInput(f"unit '{text}': say which {signal} the range belongs to, as in mA(4..20=3..15 psi)")
        low, high = 0.0, 100.0 if signal == PERCENT else 1.0
    else:
        low, high = float(found["a"]), float(found["b"])
    if low == high:
        raise BadInput(f"unit '{text}': the signal's range is empty ({low:g}..{high:g}); give two different ends")
    inner = conversion(found["unit"], quantity)
    scale = (float(found["d"]) - float(found["c"])) / (high - low)
    shift = float(found["c"]) - scale * low
    said = f"converted from {text} to {inner.unit}{_taken_off(found['unit'])}"
    return Conversion(inner.scale * scale, inner.scale * shift + inner.shift, inner.unit, said)


def _taken_off(unit: str) -> str:
    return f", {_ATMOSPHERE_PSI} psi of the atmosphere taken off" if unit.strip().lower() in _ABSOLUTE else ""


def _affine(name: str, house: str, quantity: Quantity, text: str) -> tuple[float, float]:
    """Scale and shift between two units, from the units library."""
    import pint

    registry = _registry()
    try:
        zero = float(registry.Quantity(0.0, name).to(house).magnitude)
        one = float(registry.Quantity(1.0, name).to(house).magnitude)
    except (pint.UndefinedUnitError, pint.DimensionalityError, pint.errors.DefinitionSyntaxError) as error:
        known = {"time": "s, ms, min", "pressure": "psi, kPa, bar, percent", "position": "in, mm, percent"}[quantity]
        hint = f"use {known}, or give its range as in V(0..5=0..10 {house})"
        raise BadInput(f"unit '{text}' is not a unit of {quantity}; {hint}") from error
    except Exception as error:  # the library's parser fails in many ways on what is no unit at all
        raise BadInput(f"unit '{text}' cannot be understood; use a plain name such as {house}") from error
    return one - zero, zero


@cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry(cache_folder=None)
