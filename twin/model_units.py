"""Brings a design model, with its effects, into the units of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from control.design import DesignModel
from hal.errors import BadInput
from logs.units import PERCENT, Quantity, conversion, plain_name
from twin.catalog import effect
from twin.effect import Scales

#: What an operator can do about percent beside another unit, where the record is a file.
_OF_A_FILE = "give the range with --units, as in {quantity}=percent(0..1 {unit}), or identify a model from the record"


def in_units_of(design: DesignModel, pressure_unit: str, position_unit: str, remedy: str = _OF_A_FILE) -> DesignModel:
    """The same valve in other units; `remedy` is what to do where that cannot be, for the error.

    Raises: `BadInput` when the model is in percent and the recording is not, or the other way round.
    """
    pressure = _factor(design.pressure_unit, pressure_unit, "pressure", remedy)
    position = _factor(design.position_unit, position_unit, "position", remedy)
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


def _factor(unit: str, wanted: str, quantity: Quantity, remedy: str) -> float:
    if plain_name(unit) == plain_name(wanted):
        return 1.0
    given, needed = conversion(unit, quantity), conversion(wanted, quantity)
    if PERCENT in (given.unit, needed.unit) and given.unit != needed.unit:
        raise BadInput(
            f"the model's {quantity} is in {unit} and the recording's in {wanted}, and nothing says what 100 % is; "
            + remedy.format(quantity=quantity, unit=unit)
        )
    return given.scale / needed.scale


def _scaled(name: str, table: Mapping[str, float | str], scales: Scales) -> dict[str, float | str]:
    kinds = {p.name: p.kind for form in effect(name).forms for p in form.parameters}
    return {
        key: value * scales.factor(kinds[key]) if key in kinds and isinstance(value, float | int) else value
        for key, value in table.items()
    }
