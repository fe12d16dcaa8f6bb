"""Which column of a table is the time, the command, the pressure, the position, the target, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, cast, get_args

from hal.errors import BadInput
from logs.units import Quantity, is_unit

Role = Literal["time", "command", "pressure", "position", "target"]
ROLES: tuple[Role, ...] = get_args(Role)
NEEDED: tuple[Role, ...] = ("time", "command", "position")
QUANTITY: Mapping[Role, Quantity] = {
    "time": "time",
    "command": "pressure",
    "pressure": "pressure",
    "position": "position",
    "target": "position",
}
_WORDS: Mapping[Role, frozenset[str]] = {
    "time": frozenset({"time", "t", "timestamp", "datetime", "elapsed", "elapsed time", "relative time", "x value"}),
    "command": frozenset({"command", "cmd", "u", "ep command", "e/p command", "command pressure", "pressure command"}),
    "pressure": frozenset({"pressure", "p", "press", "actuator pressure", "measured pressure", "ep pressure"}),
    "position": frozenset({"position", "pos", "x", "lvdt", "stem position", "stem", "valve position", "travel"}),
    "target": frozenset({"target", "desired", "desired position", "target position", "setpoint", "sp", "reference"}),
}


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the file: its `header` as it stands there, the `label` without unit, and the unit, "" if unsaid."""

    header: str
    label: str
    unit: str


def parse_pairs(text: str | None, option: str) -> dict[Role, str]:
    """`time=COL,command=COL` as a mapping. A column name with a comma in it can be put into double quotes.

    Raises: `BadInput` for anything that is not role=value.
    """
    pairs: dict[Role, str] = {}
    for part in re.findall(r'(?:[^,"]|"[^"]*")+', text or ""):
        role, equals, value = part.partition("=")
        role, value = role.strip(), value.strip().strip('"')
        if role not in ROLES or not equals:
            raise BadInput(f"{option}: '{part.strip()}' is not ROLE=VALUE with a role out of {', '.join(ROLES)}")
        if role in pairs:
            raise BadInput(f"{option}: '{role}' is given twice; give it once")
        pairs[cast(Role, role)] = value
    return pairs


def split_header(header: str, quantity: Quantity | None = None) -> Column:
    """Finds the unit in `pressure [kPa]`, `Pressure (bar)`, `t/ms`, `position_mm`, `pos mm`, or none.

    A unit is only taken for one when it is a unit of `quantity`, or of any quantity where that is not known.
    """
    text = header.strip().strip('"').strip()
    bracketed = re.fullmatch(r"(.*?)[\s_]*[\[(]\s*(.*?)\s*[\])]", text) or re.fullmatch(r"(.*?),\s*(\S+)", text)
    if bracketed is not None:
        return Column(header, _label(bracketed[1]), bracketed[2])
    for match in (re.fullmatch(r"(.*\S)\s*/\s*(\S+)", text), re.fullmatch(r"(.*[^_\s])[_\s]+([^_\s]+)", text)):
        if match is not None and _is_any_unit(match[2], quantity):
            return Column(header, _label(match[1]), match[2])
    return Column(header, _label(text), "")


def assign(headers: Sequence[str], mapping: Mapping[Role, str], where: str) -> dict[Role, Column]:
    """The column of each role: as `mapping` says (header or number, from 1), by name otherwise; some may be missing.

    Raises: `BadInput` when a needed role has no column, or a name fits several, with the columns there are.
    """
    found: dict[Role, Column] = {}
    free = [header for header in headers if header not in mapping.values()]
    for role in ROLES:
        if role in mapping:
            if mapping[role]:  # `--map pressure=` leaves the pressure out
                found[role] = _mapped(role, mapping[role], headers, where)
        else:
            column = _guessed(role, free, where)
            if column is not None:
                found[role] = column
    missing = [role for role in NEEDED if role not in found]
    if missing:
        raise BadInput(
            f"{where}: no column for {', '.join(missing)}; the columns are {_listed(headers)}; "
            f"name them, as in --map {','.join(f'{role}=COLUMN' for role in missing)}"
        )
    return found


def _mapped(role: Role, name: str, headers: Sequence[str], where: str) -> Column:
    ways: tuple[Callable[[str], bool], ...] = (
        lambda header: header == name,
        lambda header: header.strip().casefold() == name.casefold(),
        lambda header: split_header(header, QUANTITY[role]).label == _label(name),
    )
    for fits in ways:
        same = [header for header in headers if fits(header)]
        if len(same) == 1:
            return split_header(same[0], QUANTITY[role])
        if len(same) > 1:
            raise BadInput(f"{where}: --map {role}={name} fits {_listed(same)}; give the full header")
    if name.isdecimal() and 1 <= int(name) <= len(headers):  # no header reads so: it is the column's number
        return split_header(headers[int(name) - 1], QUANTITY[role])
    raise BadInput(f"{where}: --map {role}={name}: no such column; the columns are {_listed(headers)}")


def is_clock(label: str) -> bool:
    """Whether a column of that label, without its unit, is a time."""
    return label in _WORDS["time"]


def _guessed(role: Role, headers: Sequence[str], where: str) -> Column | None:
    columns = [split_header(header, QUANTITY[role]) for header in headers]
    exact = [column for column in columns if column.label == role]
    fits = exact or [column for column in columns if column.label in _WORDS[role]]
    if len(fits) > 1:
        names = _listed([column.header for column in fits])
        raise BadInput(f"{where}: {names} could all be the {role}; choose one, as in --map {role}=COLUMN")
    return fits[0] if fits else None


def _label(text: str) -> str:
    return re.sub(r"[\s_]+", " ", text).strip().casefold()


def _is_any_unit(text: str, quantity: Quantity | None) -> bool:
    kinds: tuple[Quantity, ...] = get_args(Quantity) if quantity is None else (quantity,)
    return any(is_unit(text, kind) for kind in kinds)


def _listed(headers: Sequence[str]) -> str:
    shown = ", ".join(f"'{header}'" for header in headers[:20])
    return shown + (f" and {len(headers) - 20} more" if len(headers) > 20 else "")
