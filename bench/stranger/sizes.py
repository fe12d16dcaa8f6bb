"""Where a case's size and a parameter of the answer are the same quantity, and whether its interval has the size.

The names are those of the published list of effects (docs/effects.md), read after the plant was finished. Only
magnitudes are compared; a size that the answer gives in another form of the cause is not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bench.stranger.ep_effects import HIGHEST_PSI
from bench.stranger.valve import TRAVEL_IN

_ROUNDING = 1e-5  # diagnosis.json has six digits; a resolution is known better than that

_Convert = Callable[[float], float]


def _same(size: float) -> float:
    return size


def _half(size: float) -> float:
    return 0.5 * size


def _per_second(size: float) -> float:
    return size / 600.0


def _of_travel(size: float) -> float:
    return size / TRAVEL_IN


def _one_slower(size: float) -> float:
    """One time constant longer by `size`: half the difference over the mean."""
    return size / (2.0 + size)


def _both_apart(size: float) -> float:
    """One time constant longer by a factor and the other shorter by it: half the difference over the mean."""
    squared = (1.0 + size) ** 2
    return (squared - 1.0) / (squared + 1.0)


#: (cause, form) -> the parameter in diagnosis.json, and its magnitude from the size.
SAME: dict[tuple[str, str], tuple[str, _Convert]] = {
    ("dead_time", "pure"): ("delay", _same),
    ("ep_calibration", "zero"): ("zero", _same),
    ("ep_deadband", "hold"): ("band", _same),
    ("ep_deadband", "play"): ("band", _half),
    ("ep_deadband", "overlap"): ("band", _same),
    ("fill_exhaust_asymmetry", "slow_exhaust"): ("asymmetry", _one_slower),
    ("fill_exhaust_asymmetry", "slow_fill"): ("asymmetry", _one_slower),
    ("fill_exhaust_asymmetry", "both"): ("asymmetry", _both_apart),
    ("ep_rate_limit", "both_ways"): ("slowness", _same),
    ("ep_rate_limit", "filling"): ("slowness_up", _same),
    ("supply_saturation", "regulated"): ("supply", lambda size: HIGHEST_PSI - size),
    ("supply_saturation", "cut_off"): ("supply", lambda size: HIGHEST_PSI - size),
    ("stiction", "karnopp"): ("breakaway", _same),
    ("stiction", "slip_jump"): ("breakaway", _same),
    ("asymmetric_damping", "slower_opening"): ("asymmetry", _one_slower),
    ("asymmetric_damping", "slower_closing"): ("asymmetry", _one_slower),
    ("asymmetric_damping", "both"): ("asymmetry", _both_apart),
    ("friction_in_motion", "share"): ("share", _same),
    ("creep", "stem"): ("share", _same),
    ("creep", "two_tails"): ("share", _same),
    ("creep", "diaphragm"): ("share", _same),
    ("friction_drift", "warm_up"): ("change", _half),
    ("friction_drift", "wear"): ("rate", lambda size: 0.5 * _per_second(size)),
    ("additional_lag", "plug"): ("lag", _same),
    ("additional_lag", "tubing"): ("lag", _same),
    ("reduced_travel", "upper"): ("missing", _of_travel),
    ("reduced_travel", "lower"): ("missing", _of_travel),
    ("lvdt_calibration", "zero"): ("zero", _same),
    ("lvdt_calibration", "gain"): ("gain", _same),
    ("lvdt_nonlinearity", "bow"): ("bow", _of_travel),
    ("lvdt_nonlinearity", "ess"): ("swing", _of_travel),
    ("lvdt_drift", "straight"): ("rate", _per_second),
    ("lvdt_drift", "settling"): ("change", _same),
    ("linkage_lost_motion", "play"): ("play", _same),
    ("sensor_lag", "one_pole"): ("lag", _same),
    ("stale_samples", "regular"): ("period", _same),
    ("stale_samples", "shared"): ("period", _same),
    ("sensor_quantization", "rounding"): ("step", _same),
    ("sensor_dropouts", "zeros"): ("rate", _same),
    ("sensor_dropouts", "full_scale"): ("rate", _same),
}


def size_covered(label: Mapping[str, Any], answer: Mapping[str, Any]) -> bool | None:
    """Whether the 95 % intervals hold the true sizes; None where the two are not the same quantity."""
    verdicts = []
    for cause in label["causes"]:
        parameter, convert = SAME.get((cause["name"], cause["form"]), ("", _same))
        for named in answer["causes"]:
            if named["name"] == cause["name"] and parameter in named["parameters"]:
                ends = sorted(abs(end) for end in named["parameters"][parameter]["ci95"])
                true = convert(cause["size"])
                verdicts.append(ends[0] * (1 - _ROUNDING) <= true <= ends[1] * (1 + _ROUNDING))
    return all(verdicts) if verdicts else None
