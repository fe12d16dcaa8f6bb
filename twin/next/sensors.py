"""Which further signal would settle what no experiment can, as words for an operator."""

from __future__ import annotations

from twin.fit.numbers import NUMBERS
from twin.model.catalog import effects

_SECOND_POSITION = "a second position signal on the stem (dial gauge, limit switch or another LVDT)"
_PRESSURE = "a measured pressure behind the E/P transducer"
_READBACK = "a second pressure gauge at the actuator"
_FLUID = "the pressure drop across the valve (or the same record with the line empty)"
_FORCE = "the stem force (a load cell), or the curve of the spring measured out of the valve"


def advice(first: str, second: str, measured_pressure: bool) -> str:
    """The signal to add for telling two causes apart."""
    names = {first, second}
    stages = {_stage(name) for name in names}
    if "flow_force" in names:
        return _FLUID
    if "sensor" in stages and len(stages) > 1:
        return _SECOND_POSITION
    if "ep" in stages:
        return _PRESSURE if not measured_pressure else _READBACK
    return _SECOND_POSITION if stages == {"sensor"} else _FORCE


def _stage(name: str) -> str:
    number = name.removeprefix("parameter:")
    return NUMBERS[number] if name.startswith("parameter:") else effects()[name].stage
