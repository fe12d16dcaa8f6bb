"""The stem's friction in the packing: LuGre bristles, viscous drag, soft rings, and what time and place change.

Source: Canudas de Wit, Olsson, Astrom & Lischinsky 1995 (LuGre); Lampaert, Al-Bender & Swevers 2003 (soft elements in
parallel, generalized Maxwell-slip).
"""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PLACE, STICKING, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled
from sim_device.physics.reference.record import AREA, PSI, RINGS

IMPERFECTIONS = (
    Imperfection(
        "stiction",
        "actuator",
        "psi",
        (0.02, 0.07, 0.26),
        "Dry packing: breakaway exceeds sliding friction by `size`, the last 40 % of it after seconds of rest.",
        limit=5.0,
    ),
    Imperfection(
        "spring_asymmetry",
        "actuator",
        "psi",
        (0.017, 0.05, 0.18),
        "A tilted stem wedges: friction grows by `size` from open to closed, so both curves change their slope.",
        limit=2.0,
        signed=True,
    ),
    Imperfection(
        "distributed_hysteresis",
        "actuator",
        "in",
        (0.003, 0.012, 0.042),
        "Sixty percent of the friction is in rings so soft that they slip only after up to `size` of motion.",
        limit=1.0,
    ),
    Imperfection(
        "position_dependent_friction",
        "actuator",
        "psi",
        (0.04, 0.125, 0.41),
        "A scored stem grips harder by `size` around one place of the stroke.",
        limit=1.4,
        signed=True,
    ),
    Imperfection(
        "friction_drift",
        "actuator",
        "psi",
        (0.011, 0.035, 0.12),
        "The packing swells with heat: sliding friction grows by `size`, two thirds of it within 5 min.",
        limit=1.4,
        signed=True,
    ),
    Imperfection(
        "intermittent_sticking",
        "actuator",
        "1",
        (0.02, 0.07, 0.25),
        "Coke between stem and bonnet triples the friction for 6 s; `size` is the chance of it in every 12 s.",
        limit=0.9,
        outsider=True,
    ),
)

_AGEING_S = 2.5
_STILL_M_S = 2.0e-6
_SOFT_SHARE = 0.6
_SEIZE_WINDOW_S, _SEIZE_S = 12.0, 6.0


@compiled
def sliding(q: Any, s: Any) -> float:
    """Sliding friction at this place and time [N], never negative."""
    share = s.x / q.travel
    psi = q.spring_asymmetry * share
    if q.position_dependent_friction != 0.0:
        place = 0.25 + 0.5 * uniform(s.seed, PLACE, 0)
        psi += q.position_dependent_friction / (1.0 + ((share - place) / 0.09) ** 2) ** 2
    if q.friction_drift != 0.0:
        psi += q.friction_drift * (1.0 - math.exp(-s.time / 270.0))
    force = max(q.sliding + psi * PSI * AREA, 0.0)
    if q.intermittent_sticking > 0.0:
        window = int(s.time / _SEIZE_WINDOW_S)
        start = (_SEIZE_WINDOW_S - _SEIZE_S) * uniform(s.seed, STICKING, 2 * window + 1)
        since = s.time - window * _SEIZE_WINDOW_S - start
        if uniform(s.seed, STICKING, 2 * window) < q.intermittent_sticking and 0.0 <= since < _SEIZE_S:
            force *= 3.0
    return float(force)


@compiled
def bristles(q: Any, s: Any, h: float) -> tuple[float, float]:
    """The LuGre force after `h` seconds as `force + slope * v` [N, N s/m] in the speed v at the end of the step.

    The bristle deflection is advanced implicitly, which keeps the stiff presliding regime stable at any step.
    """
    level = sliding(q, s)
    if q.distributed_hysteresis > 0.0:
        level *= 1.0 - _SOFT_SHARE
    if abs(s.v) < _STILL_M_S:
        s.rest = min(s.rest + h, 60.0)
    else:
        s.rest *= math.exp(-abs(s.v) * h / 1.0e-5)
    extra = (q.breakaway - 1.0) * level + q.stiction * PSI * AREA * (1.0 - 0.4 * math.exp(-s.rest / _AGEING_S))
    g = max(level + extra * math.exp(-((s.v / q.stribeck) ** 2)), 1.0)
    keep = 1.0 / (1.0 + h * abs(s.v) * q.bristle / g)
    force = q.bristle * keep * s.bristle - q.bristle_damping * (1.0 - keep) * s.bristle / h
    return float(force), float((q.bristle * h + q.bristle_damping) * keep + q.viscous)


@compiled
def settle_bristles(q: Any, s: Any, v: float, h: float) -> None:
    """Completes the step once the speed at its end is known, with the bounds of the step's start."""
    level = sliding(q, s)
    if q.distributed_hysteresis > 0.0:
        level *= 1.0 - _SOFT_SHARE
    extra = (q.breakaway - 1.0) * level + q.stiction * PSI * AREA * (1.0 - 0.4 * math.exp(-s.rest / _AGEING_S))
    g = max(level + extra * math.exp(-((s.v / q.stribeck) ** 2)), 1.0)
    s.bristle = (s.bristle + h * v) / (1.0 + h * abs(s.v) * q.bristle / g)


@compiled
def soft_rings(q: Any, s: Any, v: float, h: float) -> float:
    """Force of the soft rings [N] after they have moved with speed `v` for `h` seconds."""
    each = _SOFT_SHARE * sliding(q, s) / RINGS
    total = 0.0
    for index in range(RINGS):
        stiffness = each / (q.distributed_hysteresis * 0.0254 * (index + 0.5) / RINGS)
        s.rings[index] = min(max(s.rings[index] + stiffness * v * h, -each), each)
        total += s.rings[index]
    return total
