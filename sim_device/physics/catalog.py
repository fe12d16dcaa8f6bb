"""The plants by name. They are found: a file `plant_NAME.py` in this folder with `make(seed, **options)` is a plant."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from hal.errors import BadInput

if TYPE_CHECKING:
    from types import ModuleType

    from sim_device.physics.imperfection import Imperfection
    from sim_device.valve import ValvePhysics


def names() -> list[str]:
    """The plants that can be made, sorted; imports none of them."""
    return sorted(path.stem.removeprefix("plant_") for path in Path(__file__).parent.glob("plant_*.py"))


def _module(name: str) -> ModuleType:
    if name not in names():
        raise BadInput(f"there is no physics '{name}'; choose one of {', '.join(names())}")
    return import_module(f"sim_device.physics.plant_{name}")


def make_physics(name: str, seed: int = 0, /, **options: object) -> ValvePhysics:
    """A fresh valve of plant `name`, deterministic for `seed`.

    Options are the plant's own; all have `effects` (effect name to size) and `noise` (a factor, 0 is none).

    Raises: `BadInput` for an unknown plant, option, effect or size.
    """
    module = _module(name)
    try:
        return cast("ValvePhysics", module.make(seed, **options))
    except TypeError as error:
        raise BadInput(f"physics '{name}' does not take these options: {error}") from error


def parameters(name: str) -> tuple[Imperfection, ...]:
    """The wrong design numbers that plant `name` can have, as effects named `parameter:NAME`."""
    return cast("tuple[Imperfection, ...]", _module(name).parameters())


def imperfections(name: str) -> tuple[Imperfection, ...]:
    """Everything that can be wrong with plant `name`, with units, sizes and claims."""
    return cast("tuple[Imperfection, ...]", _module(name).imperfections())
