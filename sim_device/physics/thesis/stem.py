"""The stem follows the plate: a lag, a highest speed, stops, and what disturbs the motion."""

from __future__ import annotations

import math
from typing import Any

from sim_device.physics.chance import STICKING, uniform
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.jit import compiled
from sim_device.physics.thesis.spring import stops

IMPERFECTIONS = (
    Imperfection(
        "asymmetric_damping",
        "actuator",
        "1",
        (0.05, 0.15, 0.5),
        "Closing has the time constant (1 + size) tau, opening (1 - size) tau; or the highest speeds differ too.",
        forms=("tau", "both"),
        limit=0.9,
        signed=True,
    ),
    Imperfection(
        "friction_in_motion",
        "actuator",
        "1",
        (0.05, 0.2, 1.0),
        "This share of the friction acts on the stem while it moves, so the stem stops when the pressure reverses.",
        limit=1.0,
    ),
    Imperfection(
        "creep",
        "actuator",
        "1",
        (0.012, 0.036, 0.12),
        "This share of every motion comes late: with 8 s and 120 s, with 30 s, or spread evenly over the decades.",
        forms=("two", "one", "log"),
        limit=0.6,
    ),
    Imperfection(
        "additional_lag",
        "actuator",
        "s",
        (0.065, 0.2, 0.75),
        "A second lag, between the plate and the stem or behind the stem.",
        forms=("before", "after"),
        limit=10.0,
    ),
    Imperfection(
        "intermittent_sticking",
        "actuator",
        "1",
        (0.05, 0.15, 0.45),
        "The stem seizes for 5 s at random times; `size` is the chance of it in every 10 s.",
        limit=0.9,
        outsider=True,
    ),
)

_SEIZE_WINDOW_S, _SEIZE_S = 10.0, 5.0


@compiled
def _seized(q: Any, s: Any) -> bool:
    window = math.floor(s.time / _SEIZE_WINDOW_S)
    if uniform(s.seed, STICKING, 2 * window) >= q.intermittent_sticking:
        return False
    start = (_SEIZE_WINDOW_S - _SEIZE_S) * uniform(s.seed, STICKING, 2 * window + 1)
    since = s.time - window * _SEIZE_WINDOW_S - start
    return bool(0.0 <= since < _SEIZE_S)


@compiled
def _lagged(x: float, from_w: float, to_w: float, tau: float, h: float) -> float:
    """One lag, exact for a target that moves evenly from `from_w` to `to_w` during `h` seconds."""
    slope = (to_w - from_w) / h
    return to_w - slope * tau + (x - from_w + slope * tau) * math.exp(-h / tau)


@compiled
def _target(w: float, x: float, dead: float) -> float:
    """Where the plate pulls the stem when friction on the stem itself takes `dead` of the difference [in]."""
    if w - x > dead:
        return w - dead
    if x - w > dead:
        return w + dead
    return x


@compiled
def follow(q: Any, s: Any, from_w: float, to_w: float, h: float) -> float:
    """Moves the stem for `h` seconds while the plate goes evenly from `from_w` to `to_w`; returns its place [in]."""
    if q.additional_lag > 0.0 and q.additional_lag_form == 0:
        start = s.before
        s.before = _lagged(start, from_w, to_w, q.additional_lag, h)
        from_w, to_w = start, s.before
    x = s.motion
    if q.friction_in_motion > 0.0:
        dead = 0.5 * (q.a1 - q.a2) * q.friction_in_motion * q.compliance
        from_w, to_w = _target(from_w, x, dead), _target(to_w, x, dead)
    ahead = 0.5 * (from_w + to_w) - x
    turn = 1.0 + (q.asymmetric_damping if ahead > 0.0 else -q.asymmetric_damping)
    reach = q.rate_limit * h
    if q.asymmetric_damping_form == 1:
        reach /= turn
    moved = _lagged(x, from_w, to_w, q.tau * turn, h) - x
    low, high = stops(q)
    if q.intermittent_sticking == 0.0 or not _seized(q, s):
        s.motion = min(max(x + min(max(moved, -reach), reach), low), high)
    if q.additional_lag > 0.0 and q.additional_lag_form == 1:
        s.stem = _lagged(s.stem, x, s.motion, q.additional_lag, h)
    else:
        s.stem = s.motion
    return float(s.stem)
