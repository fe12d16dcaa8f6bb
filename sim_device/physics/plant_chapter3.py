"""The bench of the thesis's chapter 3 as we suppose it: the thesis's valve with three plausible imperfections.

The converter fills to its set point, but stops `HELD_PSI` above it when it lets air out: a relieving regulator's
hysteresis that was calibrated away for filling. The springs are 5 % stiffer than table 2-1 says. The thesis measures
neither; the sizes are chosen (docs/thesis.md, figure 3-10) and can be changed with `effects` and numbers.
"""

from __future__ import annotations

from collections.abc import Mapping

from sim_device.physics import plant_thesis
from sim_device.valve import ValvePhysics

imperfections, parameters = plant_thesis.imperfections, plant_thesis.parameters

HELD_PSI = 0.07
COMPLIANCE = 0.18  # in/psi
EFFECTS: Mapping[str, float] = {"ep_deadband/play": HELD_PSI, "ep_calibration/zero": 0.5 * HELD_PSI}


def make(
    seed: int, /, *, noise: float = 1.0, effects: Mapping[str, float] | None = None, **numbers: float
) -> ValvePhysics:
    """The bench with `effects` besides or instead (`{"ep_deadband/play": 0}`), or other design numbers (`a1=9.0`).

    Raises: `BadInput` for names, forms or sizes that this plant does not have.
    """
    named = {key.partition("/")[0] for key in effects or {}}
    kept = {key: size for key, size in EFFECTS.items() if key.partition("/")[0] not in named}
    sizes = {**kept, **(effects or {})}
    return plant_thesis.make(seed, noise=noise, effects=sizes, **{"compliance": COMPLIANCE, **numbers})
