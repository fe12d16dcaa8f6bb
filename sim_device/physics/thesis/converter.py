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
        (0.075, 0.12, 0.3),
        "The pressure cannot change faster than 1/size psi/s, in both directions or only rising.",
        forms=("both", "rise"),
        limit=60.0,
    ),
    Imperfection(
        "supply_saturation",
        "ep",
        "psi",
        (3.28, 3.31, 3.4),
        "The pressure stays below 15 psi - size; or 0.9 of that, and every filling makes the supply droop.",
        forms=("ceiling", "droop"),
        scales=(1.0, 0.97),
        limit=12.0,
        spread=False,
    ),
    Imperfection(
        "pressure_surge",
        "ep",
        "psi",
        (0.022, 0.067, 0.22),
        "Every 23 s a neighbour on the same air lets go and the pressure bulges by up to `size` for some 2 s.",
        limit=6.0,
        outsider=True,
    ),
)

NOMINAL_CEILING_PSI = 15.0
_DROOP_RECOVERY_S = 20.0
_SURGE_PERIOD_S, _SURGE_S = 23.0, 2.0
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
def _capped(q: Any, s: Any, p: float, h: float) -> float:
    """The pressure that the supply can give; in the second form the supply droops with what was drawn from it."""
    if q.supply_saturation_form == 0:
        return float(min(p, max(NOMINAL_CEILING_PSI - q.supply_saturation, 0.0)))
    # reservoir is how far the supply has drooped below its rest [psi]
    p = min(p, max(NOMINAL_CEILING_PSI - 0.9 * q.supply_saturation - s.reservoir, 0.0))
    s.reservoir += 0.05 * q.supply_saturation * max(p - s.pressure, 0.0) - s.reservoir * h / _DROOP_RECOVERY_S
    s.supply = 20.0 - s.reservoir
    return float(p)


@compiled
def _surge(q: Any, s: Any) -> float:
    """How far the pressure is pushed up now [psi]: half a sine wave, every 23 s."""
    since = (s.time + uniform(s.seed, PHASE, 1) * _SURGE_PERIOD_S) % _SURGE_PERIOD_S
    return float(q.pressure_surge * math.sin(math.pi * since / _SURGE_S)) if since < _SURGE_S else 0.0


@compiled
def pressure(q: Any, s: Any, u: float, h: float) -> float:
    """The pressure at the end of a step of `h` seconds [psi]; exact for a set point that is constant over it."""
    before = s.pressure
    if q.pressure_surge > 0.0:
        u += _surge(q, s)
    p = u + (before - u) * math.exp(-h / _time_constant(q, s, u))
    if q.ep_rate_limit > 0.0:
        reach = h / q.ep_rate_limit
        p = min(p, before + reach)
        if q.ep_rate_limit_form == 0:
            p = max(p, before - reach)
    if q.supply_saturation > 0.0:
        p = _capped(q, s, p, h)
    return float(max(p, 0.0))
