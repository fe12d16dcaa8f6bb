"""Wrong design numbers of the thesis plant as effects named `parameter:NAME`, with a size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from hal.errors import BadInput
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.thesis.record import DesignNumbers

PARAMETERS = (
    Imperfection(
        "parameter:deadband", "actuator", "psi", (0.018, 0.055, 0.19), "a1 - a2 is off by `size`.", signed=True
    ),
    Imperfection(
        "parameter:offset", "actuator", "psi", (0.009, 0.027, 0.09), "(a1 + a2) / 2 differs by `size`.", signed=True
    ),
    Imperfection("parameter:compliance", "actuator", "1", (0.0055, 0.016, 0.055), "k is 1 + size times.", signed=True),
    Imperfection("parameter:tau", "actuator", "1", (0.05, 0.15, 0.5), "tau is (1 + size) times.", signed=True),
    Imperfection(
        "parameter:rate_limit", "actuator", "1", (0.1, 0.25, 0.5), "The rate limit is (1 - size) times.", signed=True
    ),
    Imperfection(
        "parameter:ep_tau", "ep", "1", (0.2, 0.6, 2.0), "The converter lags (1 + size) times.", signed=True, lowest=-0.7
    ),
)


def split(effects: Mapping[str, float], design: DesignNumbers) -> tuple[dict[str, float], DesignNumbers]:
    """Takes the `parameter:NAME` entries out of `effects` and works them into the design numbers.

    Raises: `BadInput` for an unknown NAME or a size that leaves no valve.
    """
    rest = {}
    for name, size in effects.items():
        if name.startswith("parameter:"):
            design = _moved(design, name, size)
        else:
            rest[name] = size
    return rest, design


def _moved(d: DesignNumbers, name: str, size: float) -> DesignNumbers:
    match name.removeprefix("parameter:"):
        case "deadband" if size > d.a2 - d.a1:
            return replace(d, a1=d.a1 + size / 2, a2=d.a2 - size / 2)
        case "offset" if size > -d.a2:
            return replace(d, a1=d.a1 + size, a2=d.a2 + size)
        case "compliance" if size > -1:
            return replace(d, compliance=d.compliance * (1 + size))
        case "tau" if size > -1:
            return replace(d, tau=d.tau * (1 + size))
        case "rate_limit" if size < 1:
            return replace(d, rate_limit=d.rate_limit * (1 - size))
        case "ep_tau" if size > -1:
            return replace(d, ep_tau=d.ep_tau * (1 + size))
    known = ", ".join(item.name for item in PARAMETERS)
    raise BadInput(f"effect '{name}' with size {size} makes no valve; the design numbers are {known}")
