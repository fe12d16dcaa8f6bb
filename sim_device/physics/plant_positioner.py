"""The original pilot positioner around the thesis's valve; command in percent of stroke."""

from __future__ import annotations

from collections.abc import Mapping

from sim_device.physics.imperfection import Imperfection
from sim_device.physics.parameters import split
from sim_device.valve import ValvePhysics


def make(
    seed: int, /, *, noise: float = 1.0, effects: Mapping[str, float] | None = None, **numbers: float
) -> ValvePhysics:
    """A valve under its positioner, with `effects` of the valve, or other numbers: the pilot's (`supply=13.0`) and
    those of the valve's design.

    Raises: `BadInput` for names, forms or sizes that this plant does not have.
    """
    from sim_device.physics.positioner.plant import Pilot, PositionerValve
    from sim_device.physics.thesis.plant import checked_design

    known = Pilot.__dataclass_fields__
    pilot = Pilot(**{name: numbers.pop(name) for name in known if name in numbers})
    rest, design = split({"friction_in_motion": 1.0, **(effects or {})}, checked_design(numbers, known))
    return PositionerValve(seed, pilot, design, rest, noise)


def imperfections() -> tuple[Imperfection, ...]:
    """Everything that can be wrong behind the positioner's air: the valve and the sensor."""
    from sim_device.physics.thesis.plant import IMPERFECTIONS

    return tuple(item for item in IMPERFECTIONS if item.stage != "ep")


def parameters() -> tuple[Imperfection, ...]:
    """The design numbers of this plant that can be wrong."""
    from sim_device.physics.parameters import PARAMETERS

    return tuple(item for item in PARAMETERS if item.stage != "ep")
