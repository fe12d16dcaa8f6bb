"""The valve from first principles: compressible air, LuGre packing, stops, LVDT electronics; command in psi."""

from __future__ import annotations

from collections.abc import Mapping

from sim_device.physics.imperfection import Imperfection
from sim_device.valve import ValvePhysics


def make(
    seed: int, /, *, noise: float = 1.0, effects: Mapping[str, float] | None = None, **numbers: float
) -> ValvePhysics:
    """A healthy valve, or with `effects` ({"stiction": 0.4}) or other parts (`viscous=9e4`, SI units, see `Build`).

    Raises: `BadInput` for names, forms or sizes that this plant does not have.
    """
    from sim_device.physics.reference.parameters import checked_build, split
    from sim_device.physics.reference.plant import ReferenceValve

    rest, build = split(effects or {}, checked_build(numbers))
    return ReferenceValve(seed, build, rest, noise)


def imperfections() -> tuple[Imperfection, ...]:
    """Everything that can be wrong with this plant."""
    from sim_device.physics.reference.plant import IMPERFECTIONS

    return IMPERFECTIONS


def parameters() -> tuple[Imperfection, ...]:
    """The design numbers of this plant that can be wrong."""
    from sim_device.physics.reference.parameters import PARAMETERS

    return PARAMETERS
