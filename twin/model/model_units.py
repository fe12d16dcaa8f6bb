"""Brings a design model, with its effects, into the units of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from control.design import DesignModel
from hal.errors import BadInput
from logs.units import PERCENT, Quantity, conversion, plain_name
from twin.model.catalog import effect
from twin.model.effect import Scales

#: What an operator can do about percent beside another unit, where the record is a file.
_OF_A_FILE = "give the range of the signal, as in --units '{columns}', or identify a model from the record"

#: ... and where it is the model that is in percent, whose range no option gives.
_OF_PERCENT = "identify a model from such a recording"


def in_units_of(design: DesignModel, pressure_unit: str, position_unit: str, remedy: str = "") -> DesignModel:
    """The same valve in other units; `remedy`: what to do where that cannot be, if the record is no file.

    Raises: `BadInput` when the model is in percent and the recording is not, or the other way round.
    """
    shut = design.a1 + design.travel / design.compliance
    pressure = _factor(design.pressure_unit, pressure_unit, "pressure", shut, remedy)
    position = _factor(design.position_unit, position_unit, "position", design.travel, remedy)
    if pressure == position == 1.0:
        return replace(design, pressure_unit=pressure_unit, position_unit=position_unit)
    scales = Scales(pressure=pressure, position=position)
    return replace(
        design,
        a1=design.a1 * pressure,
        a2=design.a2 * pressure,
        compliance=design.compliance * position / pressure,
        rate_limit=design.rate_limit * position,
        travel=design.travel * position,
        pressure_unit=pressure_unit,
        position_unit=position_unit,
        effects={name: _scaled(name, table, scales) for name, table in design.effects.items()},
    )


def as_spoken(design: DesignModel) -> DesignModel:
    """The same valve in the units in which it is spoken of, for a file: without the last digits of the factors."""
    spoken = design.spoken
    if spoken.is_house:
        return design
    p, x = design.pressure_unit, design.position_unit
    return replace(
        design,
        a1=spoken.written(design.a1, p),
        a2=spoken.written(design.a2, p),
        compliance=spoken.written(design.compliance, f"{x}/{p}"),
        rate_limit=spoken.written(design.rate_limit, f"{x}/s"),
        travel=spoken.written(design.travel, x),
        pressure_unit=spoken.unit(p),
        position_unit=spoken.unit(x),
        effects={name: _spoken(name, table, design) for name, table in design.effects.items()},
    )


def _spoken(name: str, table: Mapping[str, float | str], design: DesignModel) -> dict[str, float | str]:
    scales = Scales(pressure_unit=design.pressure_unit, position_unit=design.position_unit)
    units = {p.name: scales.unit(p.kind) for form in effect(name).forms for p in form.parameters}
    return {
        key: design.spoken.written(value, units[key]) if key in units and isinstance(value, float | int) else value
        for key, value in table.items()
    }


def _factor(unit: str, wanted: str, quantity: Quantity, full: float, remedy: str) -> float:
    """`full`: what 100 % probably is, in `unit`, for the remedy."""
    if plain_name(unit) == plain_name(wanted):
        return 1.0
    given, needed = conversion(unit, quantity), conversion(wanted, quantity)
    if given.shift != 0.0:
        raise BadInput(
            f"the model has its {quantity} in [{unit}], which is not 0 where [{given.unit}] is; write it in that"
        )
    if PERCENT in (given.unit, needed.unit) and given.unit != needed.unit:
        ours = _OF_PERCENT if given.unit == PERCENT else _OF_A_FILE.format(columns=_ranged(quantity, unit, full))
        raise BadInput(
            f"the model has its {quantity} in [{unit}], the recording in [{wanted}], and nothing says what 100 % is; "
            + (remedy or ours)
        )
    return given.scale / needed.scale


def _ranged(quantity: Quantity, unit: str, full: float) -> str:
    """The units to give where a column is in percent; for a pressure the range that most converters have."""
    if quantity == "position":
        return f"position=percent(0..{full:.4g} {unit})"
    return "command=percent(3..15 psi),pressure=percent(3..15 psi)"


def _scaled(name: str, table: Mapping[str, float | str], scales: Scales) -> dict[str, float | str]:
    kinds = {p.name: p.kind for form in effect(name).forms for p in form.parameters}
    return {
        key: value * scales.factor(kinds[key]) if key in kinds and isinstance(value, float | int) else value
        for key, value in table.items()
    }
