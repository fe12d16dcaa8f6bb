"""How large a fault was said to be, against how large it was, wherever both sides measure it in the same thing.

The two sides have their own equations, so only faults are compared whose size means the same in both: a delay is a
delay, but the strength of a creep depends on the form of its tail.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from control.design import DesignModel
    from sim_device.sealed import Cause, Label

Truth = Callable[[float, "DesignModel"], float]  # from the fault's size to the true value of the model's parameter


@dataclass(frozen=True, slots=True)
class SizeCheck:
    """`error`: |estimate - truth| as a share of the fault's own size; `covered`: the truth is in the 95 % interval."""

    cause: str
    parameter: str
    estimate: float
    truth: float
    error: float
    covered: bool


def _same(size: float, _design: DesignModel) -> float:
    return size


def _of_travel(size: float, design: DesignModel) -> float:
    return size * design.travel


def _part_of_travel(size: float, design: DesignModel) -> float:
    return size / design.travel


def _of_even_widths(size: float, _design: DesignModel) -> float:
    """Seven widths from -size to size have the standard deviation of an even spread that is wider by sqrt(8 / 6)."""
    return size * math.sqrt(8.0 / 6.0)


def _of_two_lags(size: float, _design: DesignModel) -> float:
    """The exhaust is (1 + size) times as slow as the filling, or the filling (1 - size) times as the exhaust."""
    return -size / (2.0 + abs(size))


#: Fault with its form -> the model's parameter and its true value.
_EFFECTS: Mapping[str, tuple[str, Truth]] = {
    "dead_time": ("delay", _same),
    "stiction": ("breakaway", _same),
    "additional_lag": ("lag", _same),
    "sensor_lag": ("lag", _same),
    "stale_samples": ("period", _same),
    "sensor_quantization": ("step", _same),
    # a reading that falls to zero is false only where the stem is not
    "sensor_dropouts/full_scale": ("rate", _same),
    "sensor_dropouts/spike": ("rate", _same),
    "sensor_dropouts/default": ("rate", _same),
    "linkage_lost_motion/default": ("play", _same),
    "linkage_lost_motion/free": ("play", _same),
    "ep_calibration/zero": ("zero", _same),
    "ep_rate_limit/both": ("slowness", _same),
    "lvdt_calibration/gain": ("gain", _same),
    "lvdt_calibration/zero": ("zero", _of_travel),
    "reduced_travel": ("missing", _part_of_travel),
    "distributed_hysteresis/even": ("spread", _of_even_widths),
    "asymmetric_damping/tau": ("asymmetry", _same),
    "fill_exhaust_asymmetry/tau": ("asymmetry", _of_two_lags),
}
#: What the model counts in other units for one family is left out there.
_NOT = {("reference", "additional_lag")}

_NUMBERS: Mapping[str, tuple[Truth, Truth]] = {
    "deadband": (lambda s, d: d.deadband + s, lambda _s, d: d.deadband),
    "offset": (lambda s, d: d.offset + s, lambda _s, d: d.offset),
    "compliance": (lambda s, d: d.compliance * (1.0 + s), lambda _s, d: d.compliance),
    "tau": (lambda s, d: d.tau_s * (1.0 + s), lambda _s, d: d.tau_s),
    "rate_limit": (lambda s, d: d.rate_limit * (1.0 - s), lambda _s, d: d.rate_limit),
    "ep_tau": (lambda s, d: d.ep_tau_s * (1.0 + s), lambda _s, d: d.ep_tau_s),
}


def check_sizes(label: Label, said: Mapping[str, Any], design: DesignModel) -> list[SizeCheck]:
    """A check for every true cause that was named and whose size can be compared."""
    found = {str(cause["name"]): cause["parameters"] for cause in said["causes"]}
    checks = (_check(label.family, cause, found.get(cause.name, {}), design) for cause in label.causes)
    return [check for check in checks if check is not None]


def _check(family: str, cause: Cause, parameters: Mapping[str, Any], design: DesignModel) -> SizeCheck | None:
    if cause.name.startswith("parameter:"):
        name = cause.name.removeprefix("parameter:")
        truth, neutral = (value(cause.size, design) for value in _NUMBERS[name])
    else:
        entry = _EFFECTS.get(f"{cause.name}/{cause.form}") or _EFFECTS.get(cause.name)
        if entry is None or (family, cause.name) in _NOT:
            return None
        name, true_value = entry
        truth, neutral = true_value(cause.size, design), 0.0
    if name not in parameters:  # the diagnosis chose a form with other parameters
        return None
    estimate, (low, high) = float(parameters[name]["value"]), parameters[name]["ci95"]
    error = abs(estimate - truth) / abs(truth - neutral)
    return SizeCheck(cause.name, name, estimate, truth, error, bool(low <= truth <= high))
