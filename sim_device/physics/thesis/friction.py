"""Dry friction of the packing in psi of diaphragm pressure: the play between the curves, and how it varies.

The spring plate is a massless slider between the air, the spring and dry friction: it moves only while
|p - (a1 + a2)/2 - x/k| is above (a1 - a2)/2. That is the thesis's play, derived from a balance of forces.
"""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PLACE, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled

IMPERFECTIONS = (
    Imperfection(
        "stiction",
        "actuator",
        "psi",
        (0.05, 0.14, 0.3),
        "Breakaway friction exceeds sliding friction by `size`; the stem sticks after a rest (karnopp), after every "
        "slip (he), or the more the longer it has rested (aging).",
        forms=("karnopp", "he", "aging"),
        scales=(1.0, 0.5, 1.1),
        limit=5.0,
        source="Karnopp 1985; He et al. 2007; Rabinowicz 1958 for ageing contacts",
    ),
    Imperfection(
        "distributed_hysteresis",
        "actuator",
        "psi",
        (0.1, 0.2, 0.45),
        "Friction is spread over seven Maxwell-slip elements with half-widths up to `size` off the nominal.",
        forms=("even", "bell"),
        scales=(1.0, 1.3),
        limit=1.48,
        source="Iwan 1966; Al-Bender, Lampaert & Swevers 2005",
    ),
    Imperfection(
        "position_dependent_friction",
        "actuator",
        "psi",
        (0.032, 0.1, 0.36),
        "The packing grips harder by `size` around one place of the stroke, or irregularly all along it.",
        forms=("spot", "rough"),
        scales=(1.0, 0.5),
        limit=1.4,
        signed=True,
    ),
    Imperfection(
        "friction_drift",
        "actuator",
        "psi",
        (0.012, 0.036, 0.12),
        "Half the deadband grows by `size`: with a warm-up of 5 min, or evenly over every 20 min.",
        forms=("warm_up", "ramp"),
        scales=(1.0, 1.3),
        limit=1.4,
        signed=True,
    ),
)

_STICK_SPEED_IN_S = (0.004, 0.03, 0.004)
_STICK_DWELL_S = 0.1
_AGEING_S = 5.0


@compiled
def spot(q: Any, s: Any, w: float) -> float:
    """Extra friction at stroke `w` [psi]."""
    share = w / q.travel
    if q.position_dependent_friction_form == 0:
        place = 0.25 + 0.5 * uniform(s.seed, PLACE, 0)
        return float(q.position_dependent_friction * math.exp(-(((share - place) / 0.12) ** 2)))
    total = 0.0
    for wave in range(1, 4):
        phase = uniform(s.seed, PLACE, 10 + wave)
        total += math.sin(2.0 * math.pi * (wave * share + phase)) / math.sqrt(wave)
    return float(q.position_dependent_friction * total / 1.5)


@compiled
def drift(q: Any, s: Any) -> float:
    """Extra friction at this time of the run [psi]."""
    if q.friction_drift_form == 0:
        return float(q.friction_drift * (1.0 - math.exp(-s.time / 300.0)))
    return float(q.friction_drift * s.time / 1200.0)


@compiled
def holds(q: Any, s: Any, wish: float, low: float, high: float, h: float) -> bool:
    """Whether stiction keeps the slider, that wishes to go to `wish` [in], where it is.

    `low` and `high` are where the friction of sliding would let it rest; breakaway widens that by size x compliance.
    """
    form = q.stiction_form
    if s.stuck > 0.0:
        grip = q.stiction * q.compliance
        if form == 2:
            grip *= 1.0 - math.exp(-s.quiet / _AGEING_S)
        s.quiet += h
        if low - grip > s.slider or high + grip < s.slider:
            s.stuck = 0.0
            s.quiet = 0.0
            return False
        return True
    if abs(wish - s.slider) > _STICK_SPEED_IN_S[form] * h:
        s.quiet = 0.0
        return False
    s.quiet += h
    if form == 1 or s.quiet > _STICK_DWELL_S:
        s.stuck = 1.0
        s.quiet = 0.0
    return False


@compiled
def element(q: Any, index: int, count: int) -> float:
    """Half-width that element `index` of `count` has beyond the nominal one [psi]; the weighted mean is 0."""
    place = 2.0 * index / (count - 1) - 1.0
    return float(q.distributed_hysteresis * place)


@compiled
def weight(q: Any, index: int, count: int) -> float:
    """Share of the stroke that element `index` carries; the shares add to 1."""
    if q.distributed_hysteresis_form == 0:
        return 1.0 / count
    middle = (count - 1) // 2
    return (middle + 1 - abs(index - middle)) / float((middle + 1) ** 2)
