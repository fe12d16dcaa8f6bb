"""The thesis's valve behind the E/P converter; command in psi. Every effect can be switched on with a size."""

from __future__ import annotations

from collections.abc import Mapping

from sim_device.physics.imperfection import Imperfection
from sim_device.physics.parameters import split
from sim_device.valve import ValvePhysics


def make(
    seed: int, /, *, noise: float = 1.0, effects: Mapping[str, float] | None = None, **numbers: float
) -> ValvePhysics:
    """A healthy valve of table 2-1, or with `effects` ({"stiction": 0.4}) or other design numbers (`a1=9.0`).

    Raises: `BadInput` for names, forms or sizes that this plant does not have.
    """
    from sim_device.physics.thesis.plant import ThesisValve, checked_design

    rest, design = split(effects or {}, checked_design(numbers))
    return ThesisValve(seed, design, rest, noise)


def imperfections() -> tuple[Imperfection, ...]:
    """Everything that can be wrong with this plant."""
    from sim_device.physics.thesis.plant import IMPERFECTIONS

    return IMPERFECTIONS


def parameters() -> tuple[Imperfection, ...]:
    """The design numbers of this plant that can be wrong."""
    from sim_device.physics.parameters import PARAMETERS

    return PARAMETERS
