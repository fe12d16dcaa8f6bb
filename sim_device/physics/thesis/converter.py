"""The E/P converter's pressure: one lag, and what bounds or unbalances it."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import PHASE, WANDER, normal, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled

IMPERFECTIONS = (
    Imperfection(
        "fill_exhaust_asymmetry",
        "ep",
        "1",
        (0.3, 1.0, 4.0),
        "The exhaust time constant is (1 + size) times the filling one; negative sizes slow the filling instead.",
        forms=("tau", "orifice"),
        limit=20.0,
        signed=True,
    ),
    Imperfection(
        "ep_rate_limit",
        "ep",
        "s/psi",
        (0.15, 0.5, 2.0),
        "The pressure cannot change faster than 1/size psi/s, in both directions or only rising.",
        forms=("both", "rise"),
        limit=60.0,
    ),
    Imperfection(
        "supply_saturation",
        "ep",
        "psi",
        (3.4, 3.8, 4.8),
        "The pressure stays below 15 psi - size; or half of that, and every filling makes the supply droop besides.",
        forms=("ceiling", "droop"),
        limit=12.0,
    ),
    Imperfection(
        "relief_valve",
        "ep",
        "psi",
        (0.2, 0.6, 2.0),
        "Above 9 psi a relief valve lifts for 2 s in every 23 s and pulls the pressure down towards `size` below it.",
        limit=6.0,
        outsider=True,
    ),
)

NOMINAL_CEILING_PSI = 15.0
_DROOP_RECOVERY_S = 20.0
_RELIEF_PERIOD_S, _RELIEF_OPEN_S, _RELIEF_LIFT_PSI = 23.0, 2.0, 9.0
_WANDER_TICK_S, _WANDER_TAU_S, _WANDER_PSI = 0.5, 40.0, 0.003


@compiled
def wander(s: Any) -> None:
    """The slow unrest of the pilot, an Ornstein-Uhlenbeck walk of unit noise: 0.003 psi, correlated over 40 s."""
    tick = math.floor(s.time / _WANDER_TICK_S)
    while s.wander_tick < tick:
        s.wander_tick += 1
        keep = math.exp(-_WANDER_TICK_S / _WANDER_TAU_S)
        kick = math.sqrt(1.0 - keep * keep) * _WANDER_PSI
        s.wander = keep * s.wander + kick * normal(s.seed, WANDER, s.wander_tick)


@compiled
def _time_constant(q: Any, s: Any, u: float) -> float:
    size = q.fill_exhaust_asymmetry
    falling = u < s.pressure
    if size == 0.0 or falling != (size > 0.0):
        return float(q.ep_tau)
    slower = abs(size)
    if q.fill_exhaust_asymmetry_form == 1:
        # A choked port passes mass in proportion to the pressure behind it, so the last psi takes longest.
        slower *= math.sqrt(10.0 / (s.pressure + 2.0))
    return float(q.ep_tau * (1.0 + slower))


@compiled
def _ceiling(q: Any, s: Any, risen: float, h: float) -> float:
    if q.supply_saturation_form == 0:
        return float(NOMINAL_CEILING_PSI - q.supply_saturation)
    # reservoir holds how far the supply has drooped below its rest [psi]
    s.reservoir += q.supply_saturation * max(risen, 0.0) / 3.0 - s.reservoir * h / _DROOP_RECOVERY_S
    s.supply = 20.0 - s.reservoir
    return float(NOMINAL_CEILING_PSI - 0.5 * q.supply_saturation - s.reservoir)


@compiled
def _relieved(q: Any, s: Any, p: float, h: float) -> float:
    share = (s.time + uniform(s.seed, PHASE, 1) * _RELIEF_PERIOD_S) % _RELIEF_PERIOD_S
    if p > _RELIEF_LIFT_PSI and share < _RELIEF_OPEN_S:
        return float(p - q.relief_valve * (1.0 - math.exp(-h / 0.4)) / max(q.ep_tau / 0.4, 0.5))
    return p


@compiled
def pressure(q: Any, s: Any, u: float, h: float) -> float:
    """The pressure at the end of a step of `h` seconds [psi]; exact for a set point that is constant over it."""
    before = s.pressure
    p = u + (before - u) * math.exp(-h / _time_constant(q, s, u))
    if q.ep_rate_limit > 0.0:
        reach = h / q.ep_rate_limit
        p = min(p, before + reach)
        if q.ep_rate_limit_form == 0:
            p = max(p, before - reach)
    if q.relief_valve > 0.0:
        p = _relieved(q, s, p, h)
    if q.supply_saturation > 0.0:
        p = min(p, max(_ceiling(q, s, p - before, h), 0.0))
    return float(max(p, 0.0))
