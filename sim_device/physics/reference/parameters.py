"""Wrong design numbers of the reference valve, as another part built into it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace

from hal.errors import BadInput
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.reference.record import AREA, PSI, Build

PARAMETERS = (
    Imperfection(
        "parameter:deadband",
        "actuator",
        "psi",
        (0.018, 0.055, 0.19),
        "The gland is tighter by `size`.",
        signed=True,
    ),
    Imperfection(
        "parameter:offset", "actuator", "psi", (0.009, 0.027, 0.09), "The preload screw is off by `size`.", signed=True
    ),
    Imperfection(
        "parameter:compliance", "actuator", "1", (0.0055, 0.016, 0.055), "A spring softer by `size`.", signed=True
    ),
    Imperfection("parameter:tau", "actuator", "1", (0.04, 0.12, 0.42), "The damper slows by `size`.", signed=True),
    Imperfection(
        "parameter:rate_limit", "actuator", "1", (0.06, 0.15, 0.4), "The regulator is shut by `size`.", signed=True
    ),
    Imperfection("parameter:ep_tau", "ep", "1", (0.2, 0.6, 2.0), "A larger signal chamber.", signed=True, lowest=-0.7),
)


def split(effects: Mapping[str, float], build: Build) -> tuple[dict[str, float], Build]:
    """Takes the `parameter:NAME` entries out of `effects` and builds them in.

    Raises: `BadInput` for an unknown NAME or a size that leaves no valve.
    """
    rest = {}
    for name, size in effects.items():
        if name.startswith("parameter:"):
            build = _rebuilt(build, name, size)
        else:
            rest[name] = size
    return rest, build


def _rebuilt(b: Build, name: str, size: float) -> Build:
    match name.removeprefix("parameter:"):
        case "deadband" if size > -2.5:
            return replace(b, sliding=b.sliding + 0.5 * size * PSI * AREA)
        case "offset" if size > -5:
            return replace(b, preload=b.preload + size * PSI * AREA)
        case "compliance" if size > -0.9:
            # a softer spring alone would also slow the valve, so the damper and the packing are set freer
            freer = 1 / (1 + size)
            return replace(b, spring=b.spring * freer, viscous=b.viscous * freer, damper=b.damper * freer)
        case "tau" if size > -0.8:
            return replace(b, damper=b.damper * (1 + size) + b.viscous * size, damper_taper=b.damper_taper * (1 + size))
        case "rate_limit" if -2 < size < 0.95:
            return replace(b, damper_speed=b.damper_speed * (1 - size))
        case "ep_tau" if size > -0.9:
            return replace(b, nozzle_tau=b.nozzle_tau * (1 + size))
    known = ", ".join(item.name for item in PARAMETERS)
    raise BadInput(f"effect '{name}' with size {size} makes no valve; the design numbers are {known}")


def checked_build(numbers: Mapping[str, float]) -> Build:
    """The healthy build with some numbers replaced.

    Raises: `BadInput` for an unknown name or a value that is negative or not a number.
    """
    known = [field.name for field in fields(Build)]
    for name, value in numbers.items():
        if name not in known:
            raise BadInput(f"option '{name}' is not known to this plant; its numbers are {', '.join(known)}")
        if not 0.0 <= value < float("inf"):
            raise BadInput(f"option '{name}' is {value}; it must be 0 or above (SI units)")
    return replace(Build(), **numbers)
