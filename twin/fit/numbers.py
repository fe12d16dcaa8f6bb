"""The design model's own numbers as things that can be re-tuned: `parameter:NAME` of the vocabulary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from control.design import DesignModel

#: name -> stage of the chain it belongs to
NUMBERS: Mapping[str, str] = {
    "deadband": "actuator",
    "offset": "actuator",
    "compliance": "actuator",
    "tau": "actuator",
    "rate_limit": "actuator",
    "ep_tau": "ep",
}


#: What each number is, in words and in the design model's equations.
MEANINGS: Mapping[str, str] = {
    "deadband": "a1 - a2: how far the pressure turns back before the stem follows; the width of the play w.",
    "offset": "(a1 + a2) / 2: the pressure about which both curves lie; bench set, zero of the converter.",
    "compliance": "k in w = k (p - a): how far the stem goes per unit of pressure, on either curve.",
    "tau": "in dx/dt = (w - x) / tau: how long the stem takes to follow the play's output.",
    "rate_limit": "in |dx/dt| <= rate_limit: the fastest that the stem can move.",
    "ep_tau": "in dp/dt = (u - p) / ep_tau: how long the pressure takes to follow the command.",
}


def nominals(design: DesignModel) -> dict[str, float]:
    """The values of all design numbers in the design's units."""
    return {
        "deadband": design.deadband,
        "offset": design.offset,
        "compliance": design.compliance,
        "tau": design.tau_s,
        "rate_limit": design.rate_limit,
        "ep_tau": design.ep_tau_s,
    }


def nominal(design: DesignModel, name: str) -> float:
    """The value of a design number in the design's units."""
    return nominals(design)[name]


def reference(design: DesignModel, name: str) -> float:
    """The magnitude that relative changes of a number refer to: itself, or the pressure span where it is zero."""
    value = abs(nominal(design, name))
    if name in ("deadband", "offset"):
        span = design.travel / design.compliance
        return max(value, 0.25 * span)
    return value if value > 0.0 else 1.0


def unit(design: DesignModel, name: str) -> str:
    """Unit of a design number as printed."""
    p, x = design.pressure_unit, design.position_unit
    return {
        "deadband": p,
        "offset": p,
        "compliance": f"{x}/{p}",
        "tau": "s",
        "rate_limit": f"{x}/s",
        "ep_tau": "s",
    }[name]


def retuned(design: DesignModel, values: Mapping[str, float]) -> DesignModel:
    """The design with some of its numbers replaced."""
    get = nominals(design) | {name: value for name, value in values.items() if name in NUMBERS}
    return replace(
        design,
        ep_tau_s=get["ep_tau"],
        a1=get["offset"] + 0.5 * get["deadband"],
        a2=get["offset"] - 0.5 * get["deadband"],
        compliance=get["compliance"],
        tau_s=get["tau"],
        rate_limit=get["rate_limit"],
    )
