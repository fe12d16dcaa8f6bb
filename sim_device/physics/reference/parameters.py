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
    Imperfection("parameter:tau", "actuator", "1", (0.04, 0.12, 0.4), "Grease thickens tau by `size`."),
    Imperfection(
        "parameter:rate_limit", "actuator", "1", (0.028, 0.075, 0.25), "The needle is in by `size`.", signed=True
    ),
    Imperfection("parameter:ep_tau", "ep", "1", (0.2, 0.6, 2.0), "A larger signal chamber.", signed=True),
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
            # a softer spring alone would also slow the valve; thinner grease and a freer gap make up for that
            laminar = 1 - (1 - b.needle_laminar) / (1 + size) ** 2
            return replace(b, spring=b.spring / (1 + size), viscous=b.viscous / (1 + size), needle_laminar=laminar)
        case "tau" if size > -0.25:
            # the packing's drag is some 0.3 of what makes tau; the needle makes the rest
            return replace(b, viscous=b.viscous * (1 + 3.5 * size))
        case "rate_limit" if -0.9 < size < 0.9:
            # a tighter needle whose gap is longer: slow motion, which it passes laminar, meets the same resistance
            narrow = 1 - size
            laminar = 1 - (1 - b.needle_laminar) * narrow**2
            return replace(b, needle=b.needle * narrow, needle_laminar=laminar)
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
