"""The design model's numbers and their TOML. Simulating them is `twin`'s business; the equations stand in interfaces.

Source: Lustrino, "The Development of a Simple Control System to Correct Backlash", MIT 2009, table 2-1 and section 2.2.
The thesis gives no number for the converter lag and the rate limit: 0.30 s and 0.12 in/s are this project's choice.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

import tomlkit
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

from hal.errors import BadInput
from hal.toml_file import read_toml
from logs.spoken import HOUSE, Spoken


@dataclass(frozen=True, slots=True)
class DesignModel:
    """The thesis's valve as seven numbers, in the units named by `pressure_unit`, `position_unit` and seconds.

    `effects` holds the parameters of effects added by a diagnosis: effect name -> parameter name -> value. `spoken`:
    the units in which sizes are said to whoever gave the design, or the records.
    """

    ep_tau_s: float = 0.30
    a1: float = 8.78
    a2: float = 5.82
    compliance: float = 0.19
    tau_s: float = 2.7
    rate_limit: float = 0.12
    travel: float = 0.5625
    pressure_unit: str = "psi"
    position_unit: str = "in"
    effects: Mapping[str, Mapping[str, float | str]] = field(default_factory=dict)
    spoken: Spoken = field(default=HOUSE, compare=False)

    @property
    def deadband(self) -> float:
        """Width of the play in pressure, a1 - a2."""
        return self.a1 - self.a2

    @property
    def offset(self) -> float:
        """Middle of the two curves in pressure, (a1 + a2) / 2."""
        return 0.5 * (self.a1 + self.a2)

    def to_plain(self) -> dict[str, object]:
        """What makes the model, for a record's start document; how one speaks of it is no part of it."""
        return {name: value for name, value in asdict(self).items() if name != "spoken"}


def check_for_control(design: DesignModel) -> None:
    """Whether controllers and frequency analysis can work with these numbers.

    Raises: `BadInput` for a design that is not in psi and inches, or one without a deadband or a lag.
    """
    if (design.pressure_unit, design.position_unit) != ("psi", "in"):
        raise BadInput(
            f"controllers work in [psi, in], this design has [{design.pressure_unit}, {design.position_unit}]; "
            "convert the design model first"
        )
    if design.deadband <= 0.0:
        raise BadInput(
            f"this design has no deadband (a1 = {design.a1:g}, a2 = {design.a2:g} psi), so there is no lost motion to "
            "tune for or to hunt with; identify the model from a sweep that turns round"
        )
    if design.tau_s <= 0.0:
        raise BadInput(
            "this design's stem has no lag (valve.tau = 0), which no stem is without and which controllers divide by; "
            "identify the model, or say a small one, such as 0.05 s"
        )


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")


class _Units(_Strict):
    pressure: str = "psi"
    position: str = "in"
    time: str = "s"


class _Ep(_Strict):
    tau: float = Field(default=0.30, ge=0.0)


class _Valve(_Strict):
    a1: float
    a2: float
    compliance: float = Field(gt=0.0)
    tau: float = Field(ge=0.0)
    rate_limit: float = Field(gt=0.0)
    travel: float = Field(gt=0.0)


class _File(_Strict):
    units: _Units = _Units()
    ep: _Ep = _Ep(tau=0.30)
    valve: _Valve
    effects: dict[str, dict[str, float | str]] = {}


def load_design(path: Path) -> DesignModel:
    """Reads a design model file.

    Raises: `BadInput` naming the file, the key and what is wrong with it.
    """
    try:
        data = _File.model_validate(read_toml(path))
    except OSError as error:
        raise BadInput(f"{path}: the design model cannot be read ({error.strerror}); check the path") from error
    except tomllib.TOMLDecodeError as error:
        raise BadInput(f"{path}: not a TOML file ({error}); docs/model-format.md shows one") from error
    except ValidationError as error:
        raise BadInput(f"{path}: {_wrong(error.errors()[0])}") from error
    if data.units.time not in ("s", "ms", "min"):
        raise BadInput(f"{path}: units.time is {data.units.time!r}; use s, ms or min")
    if data.valve.a1 < data.valve.a2:
        raise BadInput(f"{path}: valve.a1 = {data.valve.a1} is below valve.a2 = {data.valve.a2}; swap them")
    unit_s = {"s": 1.0, "ms": 1e-3, "min": 60.0}[data.units.time]
    return DesignModel(
        ep_tau_s=data.ep.tau * unit_s,
        a1=data.valve.a1,
        a2=data.valve.a2,
        compliance=data.valve.compliance,
        tau_s=data.valve.tau * unit_s,
        rate_limit=data.valve.rate_limit / unit_s,
        travel=data.valve.travel,
        pressure_unit=data.units.pressure,
        position_unit=data.units.position,
        effects=data.effects,
    )


def _wrong(first: ErrorDetails) -> str:
    """What is wrong with a key, in words; a table is named by its key and not shown."""
    key, value = ".".join(str(part) for part in first["loc"]), first["input"]
    if first["type"] == "missing":
        return f"{key} is missing; a design model file needs it, in the units that its [units] names"
    return f"{key}: {first['msg']}" + ("" if isinstance(value, dict | list) else f" (value {value!r})")


def save_design(
    model: DesignModel, path: Path, comment: str = "", effect_units: Mapping[str, Mapping[str, str]] | None = None
) -> None:
    """Writes a design model file; `effect_units` gives the unit of each effect parameter, written as a comment."""
    document = tomlkit.document()
    for line in comment.splitlines():
        document.add(tomlkit.comment(line))
    document["units"] = {"pressure": model.pressure_unit, "position": model.position_unit, "time": "s"}
    document["ep"] = {"tau": model.ep_tau_s}
    document["valve"] = {
        "a1": model.a1,
        "a2": model.a2,
        "compliance": model.compliance,
        "tau": model.tau_s,
        "rate_limit": model.rate_limit,
        "travel": model.travel,
    }
    if model.effects:
        document["effects"] = _effects_table(model.effects, effect_units or {})
    path.write_text(tomlkit.dumps(document), encoding="utf-8")


def _effects_table(
    effects: Mapping[str, Mapping[str, float | str]], units: Mapping[str, Mapping[str, str]]
) -> tomlkit.items.Table:
    table = tomlkit.table(is_super_table=True)
    for name, parameters in effects.items():
        entry = tomlkit.table()
        for key, value in parameters.items():
            entry[key] = value
            unit = units.get(name, {}).get(key)
            if unit:
                entry[key].comment(unit)
        table[name] = entry
    return table
